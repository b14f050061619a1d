#include "firmware_app/files/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <toml++/toml.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/toml_lookup.hpp"
#include "firmware_app/files/toml_shape.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {

namespace {

void collectUnread(const TomlState& state, const toml::table& table, const std::string& prefix,
                   std::vector<std::pair<std::uint32_t, std::string>>& unread) {
  static const std::set<std::string, std::less<>> kNone;
  const auto found = state.asked.find(&table);
  const auto& asked = found == state.asked.end() ? kNone : found->second;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (!asked.contains(name)) {
      const std::vector<std::string> known(asked.begin(), asked.end());
      const std::uint32_t line = std::max(key.source().begin.line, 1U);
      unread.emplace_back(line, state.file + ":" + std::to_string(line) + ": key '" + prefix + name +
                                    "' is unknown" + suggestion(name, known));
    } else if (const toml::table* sub = node.as_table()) {
      collectUnread(state, *sub, prefix + name + ".", unread);
    } else if (node.is_array_of_tables()) {
      const toml::array& array = *node.as_array();
      for (std::size_t i = 0; i < array.size(); ++i) {
        collectUnread(state, *array[i].as_table(), prefix + name + "[" + std::to_string(i + 1) + "].",
                      unread);
      }
    }
  }
}

}  // namespace

bool Range::contains(double value) const noexcept {
  return std::isfinite(value) && (minimum_open ? value > minimum : value >= minimum) &&
         (maximum_open ? value < maximum : value <= maximum);
}

std::string Range::text() const {
  if (std::isinf(minimum) && std::isinf(maximum)) {
    return "";
  }
  if (std::isinf(maximum)) {
    return (minimum_open ? "greater than " : "of at least ") + formatNumber(minimum);
  }
  if (std::isinf(minimum)) {
    return (maximum_open ? "less than " : "of at most ") + formatNumber(maximum);
  }
  return std::string("in ") + (minimum_open ? "(" : "[") + formatNumber(minimum) + ", " +
         formatNumber(maximum) + (maximum_open ? ")" : "]");
}

TomlTable::TomlTable(std::shared_ptr<TomlState> state, const void* node, std::string prefix,
                     std::uint32_t line)
    : state_(std::move(state)), node_(node), prefix_(std::move(prefix)), line_(line) {}

bool TomlTable::has(std::string_view key) const {
  return present() && tableOf(node_).contains(key);
}

bool TomlTable::isTable(std::string_view key) const {
  return has(key) && tableOf(node_)[key].is_table();
}

std::vector<std::string> TomlTable::keys() const {
  if (!present()) {
    return {};
  }
  std::vector<std::pair<toml::source_position, std::string>> located;
  for (const auto& [key, node] : tableOf(node_)) {
    located.emplace_back(key.source().begin, key.str());
  }
  std::sort(located.begin(), located.end());
  std::vector<std::string> names;
  for (auto& [position, name] : located) {
    names.push_back(std::move(name));
  }
  return names;
}

double TomlTable::number(std::string_view key, Range range) const {
  const Lookup lookup(*state_, *this, node_, key, expectedNumber(range));
  return lookup.readNumber(lookup.require(), range);
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t minimum, std::int64_t maximum) const {
  const Lookup lookup(*state_, *this, node_, key,
                      "an integer in [" + std::to_string(minimum) + ", " + std::to_string(maximum) + "]");
  const toml::value<std::int64_t>* value = lookup.require().as_integer();
  if (value == nullptr || value->get() < minimum || value->get() > maximum) {
    lookup.reject(*lookup.node);
  }
  return value->get();
}

bool TomlTable::boolean(std::string_view key) const {
  const Lookup lookup(*state_, *this, node_, key, "true or false");
  const toml::value<bool>* value = lookup.require().as_boolean();
  if (value == nullptr) {
    lookup.reject(*lookup.node);
  }
  return value->get();
}

std::string TomlTable::string(std::string_view key) const {
  const Lookup lookup(*state_, *this, node_, key, "a string that is not empty");
  const toml::value<std::string>* value = lookup.require().as_string();
  if (value == nullptr || value->get().empty()) {
    lookup.reject(*lookup.node);
  }
  return value->get();
}

std::string TomlTable::choice(std::string_view key, std::span<const std::string> allowed) const {
  const Lookup lookup(*state_, *this, node_, key, "one of " + quotedList(allowed));
  const toml::value<std::string>* value = lookup.require().as_string();
  if (value == nullptr || std::find(allowed.begin(), allowed.end(), value->get()) == allowed.end()) {
    lookup.reject(*lookup.node);
  }
  return value->get();
}

std::vector<double> TomlTable::numbers(std::string_view key, CountRange count, Range range) const {
  const std::string bounds = range.text();
  const Lookup lookup(*state_, *this, node_, key,
                      expectedCount(count) + " finite numbers" + (bounds.empty() ? "" : ", each " + bounds));
  std::vector<double> values;
  for (const toml::node& element : lookup.readArray(count)) {
    values.push_back(lookup.readNumber(element, range));
  }
  return values;
}

std::vector<std::string> TomlTable::strings(std::string_view key, CountRange count) const {
  const Lookup lookup(*state_, *this, node_, key, expectedCount(count) + " strings");
  std::vector<std::string> values;
  for (const toml::node& element : lookup.readArray(count)) {
    const toml::value<std::string>* value = element.as_string();
    if (value == nullptr || value->get().empty()) {
      lookup.reject(element);
    }
    values.push_back(value->get());
  }
  return values;
}

std::filesystem::path TomlTable::path(std::string_view key) const {
  return (std::filesystem::path(state_->file).parent_path() / string(key)).lexically_normal();
}

std::filesystem::path TomlTable::existing(std::string_view key) const {
  const std::filesystem::path found = path(key);
  std::error_code ignored;
  if (!std::filesystem::exists(found, ignored)) {
    throw error(key, "there is no file " + found.string() + ", expected a path from the folder of this file");
  }
  return found;
}

template <typename Read, typename Value>
Value TomlTable::valueOr(std::string_view key, const Value& fallback, Read&& read) const {
  if (has(key)) {
    return read();
  }
  if (present()) {
    state_->asked[node_].emplace(key);
  }
  return fallback;
}

double TomlTable::number(std::string_view key, Range range, double fallback) const {
  return valueOr(key, fallback, [&] { return number(key, range); });
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t minimum, std::int64_t maximum,
                                std::int64_t fallback) const {
  return valueOr(key, fallback, [&] { return integer(key, minimum, maximum); });
}

bool TomlTable::boolean(std::string_view key, bool fallback) const {
  return valueOr(key, fallback, [&] { return boolean(key); });
}

std::string TomlTable::string(std::string_view key, std::string_view fallback) const {
  return valueOr(key, std::string(fallback), [&] { return string(key); });
}

std::string TomlTable::choice(std::string_view key, std::span<const std::string> allowed,
                              std::string_view fallback) const {
  return valueOr(key, std::string(fallback), [&] { return choice(key, allowed); });
}

std::vector<double> TomlTable::numbers(std::string_view key, CountRange count, Range range,
                                       std::span<const double> fallback) const {
  return valueOr(key, std::vector<double>(fallback.begin(), fallback.end()),
                 [&] { return numbers(key, count, range); });
}

std::vector<std::string> TomlTable::strings(std::string_view key, CountRange count,
                                            std::span<const std::string> fallback) const {
  return valueOr(key, std::vector<std::string>(fallback.begin(), fallback.end()),
                 [&] { return strings(key, count); });
}

TomlTable TomlTable::table(std::string_view key) const {
  const Lookup lookup(*state_, *this, node_, key, "a table");
  const toml::table* sub = lookup.require().as_table();
  if (sub == nullptr) {
    lookup.reject(*lookup.node);
  }
  return {state_, sub, prefix_ + std::string(key) + ".", lineOf(*sub)};
}

TomlTable TomlTable::optionalTable(std::string_view key) const {
  const TomlTable absent(state_, nullptr, prefix_ + std::string(key) + ".", line_);
  return valueOr(key, absent, [&] { return table(key); });
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  const Lookup lookup(*state_, *this, node_, key, "an array of tables");
  std::vector<TomlTable> result;
  if (lookup.node == nullptr) {
    return result;
  }
  const toml::array* array = lookup.node->as_array();
  if (array == nullptr || (!array->empty() && !array->is_array_of_tables())) {
    lookup.reject(*lookup.node);
  }
  for (const toml::node& element : *array) {
    result.push_back({state_, element.as_table(),
                      prefix_ + std::string(key) + "[" + std::to_string(result.size() + 1) + "].",
                      lineOf(element)});
  }
  return result;
}

void TomlTable::finish() const {
  if (!present()) {
    return;
  }
  std::vector<std::pair<std::uint32_t, std::string>> unread;
  collectUnread(*state_, tableOf(node_), prefix_, unread);
  if (unread.empty()) {
    return;
  }
  std::sort(unread.begin(), unread.end());
  std::string text;
  constexpr std::size_t kMostTold = 20;
  for (std::size_t i = 0; i < std::min(unread.size(), kMostTold); ++i) {
    text += (text.empty() ? "" : "\n") + unread[i].second;
  }
  if (unread.size() > kMostTold) {
    text += "\nand " + std::to_string(unread.size() - kMostTold) + " more";
  }
  throw FileError(text);
}

FileError TomlTable::error(std::string_view key, std::string_view problem) const {
  const toml::node* node = present() ? tableOf(node_).get(key) : nullptr;
  return FileError(state_->file + ":" + std::to_string(node != nullptr ? lineOf(*node) : line_) + ": key '" +
                   fullName(key) + "': " + std::string(problem));
}

std::string TomlTable::fullName(std::string_view key) const {
  return prefix_ + std::string(key);
}

std::string TomlTable::origin() const {
  return state_->file + ":" + std::to_string(line_) + ": key '" + prefix_.substr(0, prefix_.size() - 1) + "'";
}

TomlDocument TomlDocument::load(const std::filesystem::path& path) {
  return parse(readFile(path), path.string());
}

TomlDocument TomlDocument::parse(std::string_view text, const std::string& name) {
  checkTomlShape(text, name);
  auto state = std::make_shared<TomlState>();
  state->file = name;
  try {
    state->root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw FileError(name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
                    std::string(error.description()));
  }
  const toml::table* root = &state->root;
  return TomlDocument(TomlTable(std::move(state), root, "", 1));
}

}  // namespace patella::app
