#include "firmware_app/files/toml_lookup.hpp"

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// A value as the file shows it, shortened.
std::string shown(const toml::node& node) {
  if (node.is_table()) {
    return "a table";
  }
  if (const toml::value<double>* number = node.as_floating_point()) {
    return formatNumber(number->get());
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  constexpr std::size_t kLongest = 60;
  std::string result = text.str();
  if (result.size() > kLongest) {
    result = result.substr(0, kLongest) + "...";
  }
  return result;
}

}  // namespace

std::uint32_t lineOf(const toml::node& node) {
  return std::max(node.source().begin.line, 1U);
}

std::string expectedNumber(const Range& range) {
  const std::string bounds = range.text();
  return bounds.empty() ? "a finite number" : "a number " + bounds;
}

std::string expectedCount(const CountRange& count) {
  if (count.minimum == count.maximum) {
    return "an array of " + std::to_string(count.minimum);
  }
  if (count.maximum == CountRange{}.maximum) {
    return "an array of at least " + std::to_string(count.minimum);
  }
  return "an array of " + std::to_string(count.minimum) + " to " + std::to_string(count.maximum);
}

Lookup::Lookup(TomlState& in_state, const TomlTable& in_table, const void* in_node, std::string_view in_key,
               std::string in_expected)
    : state(in_state), table(in_table), table_node(in_node), key(in_key), expected(std::move(in_expected)) {
  if (table_node != nullptr) {
    state.asked[table_node].emplace(key);
    node = tableOf(table_node).get(key);
  }
}

const toml::node& Lookup::require() const {
  if (node == nullptr) {
    std::vector<std::string> unread = table.keys();
    std::erase_if(unread, [&](const std::string& name) { return state.asked[table_node].contains(name); });
    const std::string like = nearestName(key, unread);
    throw FileError(state.file + ":" + std::to_string(table.line()) + ": key '" + table.fullName(key) +
                    "' is missing, expected " + expected +
                    (like.empty() ? "" : "; there is '" + like + "' in its place"));
  }
  return *node;
}

void Lookup::reject(const toml::node& culprit) const {
  throw FileError(state.file + ":" + std::to_string(lineOf(culprit)) + ": key '" + table.fullName(key) +
                  "': value " + shown(culprit) + ", expected " + expected);
}

double Lookup::readNumber(const toml::node& value, const Range& range) const {
  const auto number = value.is_number() ? value.value<double>() : std::nullopt;
  if (!number || !range.contains(*number)) {
    reject(value);
  }
  return *number;
}

const toml::array& Lookup::readArray(const CountRange& count) const {
  const toml::array* array = require().as_array();
  if (array == nullptr) {
    reject(*node);
  }
  if (array->size() < count.minimum || array->size() > count.maximum) {
    throw FileError(state.file + ":" + std::to_string(lineOf(*node)) + ": key '" + table.fullName(key) +
                    "': " + std::to_string(array->size()) + " elements, expected " + expected);
  }
  return *array;
}

}  // namespace patella::app
