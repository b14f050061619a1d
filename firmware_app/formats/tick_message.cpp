#include "firmware_app/formats/tick_message.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"

namespace patella::formats {
namespace {

struct Type {
  FieldType type;
  std::string_view name;
};
constexpr std::array kTypes = {Type{FieldType::kFloat64, "float64"}, Type{FieldType::kUint8, "uint8"},
                               Type{FieldType::kUint32, "uint32"}};

// Columns that hold whole numbers.
constexpr std::array<std::pair<std::string_view, FieldType>, 6> kWholeNumbers = {
    {{"state", FieldType::kUint8},
     {"faults", FieldType::kUint32},
     {"limits", FieldType::kUint32},
     {"limits_from_joint5", FieldType::kUint32},
     {"encoder_steps", FieldType::kUint8},
     {"missed_periods", FieldType::kUint32}}};

std::string_view nameOf(FieldType type) {
  return std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& t) { return t.type == type; })->name;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string upperCase(std::string_view text) {
  std::string upper(text);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return upper;
}

struct Numbered {
  std::string before, after;
  std::size_t number = 0;
};

// "tau_cmd2_Nm" is the second of tau_cmd_Nm, "activation1" the first of activation; "t_s" has no number.
std::optional<Numbered> numbered(const std::string& column) {
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const auto first = std::find_if(column.begin(), column.end(), is_digit);
  const auto end = std::find_if_not(first, column.end(), is_digit);
  if (first == column.begin() || first == column.end() || (end != column.end() && *end != '_')) {
    return std::nullopt;
  }
  Numbered result{{column.begin(), first}, {end, column.end()}, 0};
  const char* digits = column.data() + (first - column.begin());
  std::from_chars(digits, column.data() + (end - column.begin()), result.number);
  return result;
}

std::string constants(std::string_view field) {
  std::string text;
  const auto constant = [&](std::string_view type, std::string_view kind, std::string_view name,
                            std::uint64_t value) {
    text += std::string(type) + " " + std::string(kind) + "_" + upperCase(name) + "=" +
            std::to_string(value) + "\n";
  };
  if (field == "state") {
    for (int i = 0; i < safety::kStateCount; ++i) {
      constant("uint8", "STATE", safety::stateName(static_cast<safety::State>(i)),
               static_cast<std::uint64_t>(i));
    }
  } else if (field == "faults") {
    for (int i = 0; i < safety::kFaultCount; ++i) {
      const auto fault = static_cast<safety::Fault>(i);
      constant("uint32", "FAULT", safety::faultName(fault), safety::FaultSet{fault}.bits());
    }
  }
  return text;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(end + 1);
  }
}

// A line of a definition: "float64[2] q_rad"; nothing for comments, constants and empty lines.
std::optional<TickField> fieldOf(const std::string& line) {
  if (line.empty() || line.front() == '#' || line.find('=') != std::string::npos) {
    return std::nullopt;
  }
  const std::size_t blank = line.find(' ');
  const std::size_t bracket = line.find('[');
  const bool is_array = bracket < blank;
  const std::string type = line.substr(0, is_array ? bracket : blank);
  const auto known =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& t) { return t.name == type; });
  TickField field{.name = blank == std::string::npos ? "" : line.substr(blank + 1), .is_array = is_array};
  bool sound = known != kTypes.end() && !field.name.empty();
  if (sound && is_array) {
    const char* end = line.data() + blank;
    const auto [rest, error] = std::from_chars(line.data() + bracket + 1, end, field.count);
    sound = error == std::errc() && rest + 1 == end && *rest == ']';
  }
  if (!sound) {
    throw std::invalid_argument("a field '" + line +
                                "', expected float64, uint8 or uint32, or a fixed array of them, and a name");
  }
  field.type = known->type;
  return field;
}

template <typename Number>
Number whole(double value, const TickField& field) {
  if (!(value >= 0.0 && value <= static_cast<double>(std::numeric_limits<Number>::max()))) {
    throw std::invalid_argument("column '" + field.name + "': value " + std::to_string(value) +
                                ", expected a whole number up to " +
                                std::to_string(std::numeric_limits<Number>::max()));
  }
  return static_cast<Number>(value);
}

}  // namespace

std::vector<TickField> tickFields(const std::vector<std::string>& columns) {
  std::vector<TickField> fields;
  std::string group;
  for (const std::string& column : columns) {
    const auto part = numbered(column);
    const std::string name = lowerCase(part ? part->before + part->after : column);
    if (part && part->number > 1 && group == name && fields.back().count + 1 == part->number) {
      ++fields.back().count;
      continue;
    }
    const bool is_array = part && part->number == 1;
    group = is_array ? name : "";
    const auto* whole = std::find_if(kWholeNumbers.begin(), kWholeNumbers.end(),
                                     [&](const auto& entry) { return entry.first == column; });
    fields.push_back({.name = is_array ? name : lowerCase(column),
                      .type = whole == kWholeNumbers.end() ? FieldType::kFloat64 : whole->second,
                      .count = 1,
                      .is_array = is_array});
  }
  return fields;
}

std::string tickDefinition(const std::vector<TickField>& fields) {
  std::string text =
      "# One tick of the loop. Units are in the names; NaN stands for what was not known in the tick.\n";
  for (const TickField& field : fields) {
    text += constants(field.name);
    text += nameOf(field.type);
    text += field.is_array ? "[" + std::to_string(field.count) + "] " : " ";
    text += field.name + "\n";
  }
  return text;
}

void encodeTick(CdrWriter& out, const std::vector<TickField>& fields, std::span<const double> row) {
  std::size_t at = 0;
  for (const TickField& field : fields) {
    for (std::size_t i = 0; i < field.count; ++i) {
      const double value = row[at++];
      switch (field.type) {
        case FieldType::kFloat64:
          out.put(value);
          break;
        case FieldType::kUint8:
          out.put(whole<std::uint8_t>(value, field));
          break;
        case FieldType::kUint32:
          out.put(whole<std::uint32_t>(value, field));
          break;
      }
    }
  }
}

TickDecoder::TickDecoder(std::string_view definition, std::string_view columns)
    : columns_(split(columns, ',')) {
  std::size_t count = 0;
  for (const std::string& line : split(definition, '\n')) {
    if (const auto field = fieldOf(line)) {
      fields_.push_back(*field);
      count += field->count;
    }
  }
  if (count != columns_.size()) {
    throw std::invalid_argument("a definition of " + std::to_string(count) + " numbers for " +
                                std::to_string(columns_.size()) + " columns");
  }
}

void TickDecoder::decode(std::string_view message, std::vector<double>& row) const {
  CdrReader reader(message);
  row.clear();
  for (const TickField& field : fields_) {
    for (std::size_t i = 0; i < field.count; ++i) {
      switch (field.type) {
        case FieldType::kFloat64:
          row.push_back(reader.number<double>());
          break;
        case FieldType::kUint8:
          row.push_back(reader.number<std::uint8_t>());
          break;
        case FieldType::kUint32:
          row.push_back(reader.number<std::uint32_t>());
          break;
      }
    }
  }
}

}  // namespace patella::formats
