#include "drivers/canopen/data_sheet.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <sstream>
#include <system_error>

#include <boost/property_tree/ini_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include "drivers/canopen/hexadecimal.hpp"
#include "drivers/files/regular_file.hpp"

namespace patella::canopen {
namespace {

using Tree = boost::property_tree::ptree;

constexpr std::size_t kMostSections = 20'000;

/// Data types of CiA 301.
constexpr int kInteger8 = 0x02;
constexpr int kInteger16 = 0x03;
constexpr int kInteger32 = 0x04;
constexpr int kUnsigned8 = 0x05;
constexpr int kUnsigned16 = 0x06;
constexpr int kUnsigned32 = 0x07;
constexpr int kBoolean = 0x01;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return result;
}

/// One section of the file with what messages need.
struct Section {
  const std::string& source;
  std::string name;
  std::map<std::string, std::string> keys;  ///< in lower case

  [[noreturn]] void fail(const char* key, const std::string& problem) const {
    throw DataSheetError(source + ": [" + name + "] " + key + ": " + problem);
  }
  const std::string* find(const char* key) const {
    const auto found = keys.find(lower(key));
    return found == keys.end() || found->second.empty() ? nullptr : &found->second;
  }
};

/// A number of CiA 306: decimal, 0x hexadecimal, or with a leading 0 octal.
std::optional<std::int64_t> plainNumber(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  text.remove_prefix(negative ? 1 : 0);
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text.front() == '0') {
    base = 8;
  }
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return negative ? -static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
}

std::int64_t toNumber(const Section& section, const char* key, const std::string& text, int node) {
  std::string compact;
  std::copy_if(text.begin(), text.end(), std::back_inserter(compact), [](char c) { return c != ' '; });
  constexpr std::string_view kNode = "$nodeid";
  const std::string folded = lower(compact);
  std::int64_t sum = 0;
  // At most two terms, one of them the node's number.
  const std::size_t plus = folded.find('+');
  const bool has_node = folded.find(kNode) != std::string::npos;
  const std::array<std::string, 2> terms = {folded.substr(0, plus),
                                            plus == std::string::npos ? "" : folded.substr(plus + 1)};
  for (const std::string& term : terms) {
    if (term.empty() && plus == std::string::npos) {
      continue;
    }
    const std::optional<std::int64_t> number = term == kNode ? node : plainNumber(term);
    if (!number || (plus != std::string::npos && !has_node)) {
      section.fail(key, "value '" + text + "', expected a number such as 16, 0x10 or $NODEID+0x180");
    }
    sum += *number;
  }
  return sum;
}

std::int64_t numberOr(const Section& section, const char* key, int node, std::int64_t fallback) {
  const std::string* text = section.find(key);
  return text == nullptr ? fallback : toNumber(section, key, *text, node);
}

/// "6071" or "1018sub1"; nothing for sections that are no entry.
std::optional<std::pair<std::uint16_t, std::uint8_t>> entryOf(const std::string& section) {
  const std::string name = lower(section);
  const auto hex = [](std::string_view text, unsigned& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    return !text.empty() && error == std::errc() && end == text.data() + text.size();
  };
  unsigned index = 0;
  unsigned sub = 0;
  if (name.size() < 4 || !hex(std::string_view(name).substr(0, 4), index)) {
    return std::nullopt;
  }
  const std::string_view rest = std::string_view(name).substr(4);
  constexpr std::string_view kSub = "sub";
  const bool has_sub = rest.starts_with(kSub) && rest.size() <= kSub.size() + 2 && hex(rest.substr(3), sub);
  if (!rest.empty() && !has_sub) {
    return std::nullopt;
  }
  return std::pair{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
}

DataSheetEntry readEntry(const Section& section, int node) {
  DataSheetEntry entry;
  entry.section = section.name;
  constexpr std::int64_t kLastType = 0xFFFF;
  const std::int64_t type = numberOr(section, "DataType", node, 0);
  if (type < 0 || type > kLastType) {
    section.fail("DataType", "value '" + *section.find("DataType") + "', expected 0x0001 to 0xFFFF");
  }
  entry.data_type = static_cast<int>(type);
  const std::string* access = section.find("AccessType");
  const std::string kind = access == nullptr ? "" : lower(*access);
  constexpr std::array<std::string_view, 6> kKinds = {"ro", "wo", "rw", "rwr", "rww", "const"};
  if (access != nullptr && std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end()) {
    section.fail("AccessType", "value '" + *access + "', expected ro, wo, rw, rwr, rww or const");
  }
  entry.writable = kind.starts_with("rw") || kind == "wo";
  entry.mappable = numberOr(section, "PDOMapping", node, 0) != 0;
  const bool number = type >= kBoolean && type <= kUnsigned32;
  if (section.find("ParameterValue") != nullptr) {
    // What is no number is refused where it would have to be written.
    entry.parameter = number ? numberOr(section, "ParameterValue", node, 0) : 0;
  }
  return entry;
}

Tree parseIni(std::string_view text, const std::string& name) {
  Tree tree;
  std::istringstream stream{std::string(text)};
  try {
    boost::property_tree::read_ini(stream, tree);
  } catch (const boost::property_tree::ini_parser_error& error) {
    throw DataSheetError(name + ":" + std::to_string(error.line()) + ": " + error.message() +
                         ", expected [section] or key=value, each once");
  }
  return tree;
}

int bytesOf(int data_type) noexcept {
  switch (data_type) {
    case kBoolean:
    case kInteger8:
    case kUnsigned8:
      return 1;
    case kInteger16:
    case kUnsigned16:
      return 2;
    case kInteger32:
    case kUnsigned32:
      return 4;
    default:
      return 0;
  }
}

/// An object of cyclic synchronous torque.
struct Needed {
  std::uint16_t index;
  int data_type;  ///< 0: a record
  bool mapped;
  const char* what;
};

constexpr std::array<Needed, 17> kNeeded{{
    {0x1000, kUnsigned32, false, "device type"},
    {0x1016, 0, false, "consumer heartbeat time"},
    {0x1017, kUnsigned16, false, "producer heartbeat time"},
    {0x1018, 0, false, "identity"},
    {0x1400, 0, false, "RPDO1"},
    {0x1600, 0, false, "mapping of RPDO1"},
    {0x1800, 0, false, "TPDO1"},
    {0x1A00, 0, false, "mapping of TPDO1"},
    {0x6040, kUnsigned16, true, "controlword"},
    {0x6041, kUnsigned16, true, "status word"},
    {0x6060, kInteger8, false, "modes of operation"},
    {0x6061, kInteger8, false, "modes of operation display"},
    {0x6064, kInteger32, true, "position actual value"},
    {0x6071, kInteger16, true, "target torque"},
    {0x6076, kUnsigned32, false, "motor rated torque"},
    {0x6077, kInteger16, true, "torque actual value"},
    {0x6502, kUnsigned32, false, "supported drive modes"},
}};

}  // namespace

DataSheet parseDataSheet(std::string_view text, const std::string& name, int node) {
  const Tree tree = parseIni(text, name);
  if (tree.size() > kMostSections) {
    throw DataSheetError(name + ": " + std::to_string(tree.size()) + " sections, expected at most " +
                         std::to_string(kMostSections));
  }
  DataSheet sheet;
  sheet.source = name;
  for (const auto& [title, keys] : tree) {
    Section section{sheet.source, title, {}};
    for (const auto& [key, value] : keys) {
      section.keys[lower(key)] = value.data();
    }
    if (lower(title) == "deviceinfo") {
      sheet.vendor = static_cast<std::uint32_t>(numberOr(section, "VendorNumber", node, 0));
      sheet.product = static_cast<std::uint32_t>(numberOr(section, "ProductNumber", node, 0));
    } else if (const auto entry = entryOf(title)) {
      sheet.entries.insert_or_assign(*entry, readEntry(section, node));
    }
  }
  if (sheet.entries.empty()) {
    throw DataSheetError(name + ": holds no object, expected sections such as [1000] and [6041]");
  }
  return sheet;
}

DataSheet loadDataSheet(const std::filesystem::path& path, int node) {
  std::string text;
  try {
    text = files::readWhole(path, files::kDataSheet);
  } catch (const std::runtime_error& error) {
    throw DataSheetError(error.what());
  }
  return parseDataSheet(text, path.string(), node);
}

void requireTorqueDrive(const DataSheet& sheet) {
  for (const Needed& needed : kNeeded) {
    const std::string named = hexadecimal(needed.index, 4) + ", " + needed.what;
    const auto found = sheet.entries.find({needed.index, std::uint8_t{0}});
    if (found == sheet.entries.end()) {
      throw DataSheetError(sheet.source + ": has no object " + named +
                           ", expected that of a drive with cyclic synchronous torque");
    }
    const DataSheetEntry& entry = found->second;
    const std::string where = sheet.source + ": [" + entry.section + "] ";
    if (needed.data_type != 0 && entry.data_type != needed.data_type) {
      throw DataSheetError(where + "DataType: value " +
                           hexadecimal(static_cast<std::uint32_t>(entry.data_type), 4) + ", expected " +
                           hexadecimal(static_cast<std::uint32_t>(needed.data_type), 4) + " for " +
                           needed.what);
    }
    if (needed.mapped && !entry.mappable) {
      throw DataSheetError(where + "PDOMapping: value 0, expected 1: " + needed.what + " has to be in a PDO");
    }
  }
}

std::vector<ObjectValue> parametersOf(const DataSheet& sheet) {
  constexpr std::uint16_t kFirst = 0x2000;
  constexpr std::array<std::uint16_t, 4> kOwn = {0x6040, 0x6060, 0x6071, 0x60C2};
  std::vector<ObjectValue> values;
  for (const auto& [place, entry] : sheet.entries) {
    const auto [index, sub] = place;
    const bool own = index < kFirst || std::find(kOwn.begin(), kOwn.end(), index) != kOwn.end();
    if (!entry.parameter || !entry.writable || own) {
      continue;
    }
    const int bytes = bytesOf(entry.data_type);
    const std::string where = sheet.source + ": [" + entry.section + "] ParameterValue: ";
    if (bytes == 0) {
      throw DataSheetError(where + "of DataType " +
                           hexadecimal(static_cast<std::uint32_t>(entry.data_type), 4) +
                           ", expected an integer of at most 4 bytes, or no value");
    }
    const int bits = 8 * bytes;
    const std::int64_t value = *entry.parameter;
    if (value < -(std::int64_t{1} << (bits - 1)) || value >= std::int64_t{1} << bits) {
      throw DataSheetError(where + "value " + std::to_string(value) + ", expected one of " +
                           std::to_string(bits) + " bits");
    }
    values.push_back({index, sub, bytes, static_cast<std::uint32_t>(value)});
  }
  return values;
}

}  // namespace patella::canopen
