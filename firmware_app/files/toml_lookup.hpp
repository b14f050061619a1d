// A key of a TOML table as its getters look it up: marked as known, and what is wrong with it reported.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

struct TomlState {
  toml::table root;
  std::string file;
  std::map<const void*, std::set<std::string, std::less<>>> asked;  // per table
};

/// A table as TomlTable keeps it.
inline const toml::table& tableOf(const void* node) {
  return *static_cast<const toml::table*>(node);
}

/// Line in its file, from 1.
std::uint32_t lineOf(const toml::node& node);

/// What was expected, in words.
std::string expectedNumber(const Range& range);
std::string expectedCount(const CountRange& count);

/// Throws FileError with file, line, key, value and what was expected.
struct Lookup {
  TomlState& state;
  const TomlTable& table;
  const void* table_node;  ///< nullptr where the table is not there
  std::string key;
  std::string expected;
  const toml::node* node = nullptr;  ///< nullptr where the key is not there

  Lookup(TomlState& in_state, const TomlTable& in_table, const void* in_node, std::string_view in_key,
         std::string in_expected);

  const toml::node& require() const;
  double readNumber(const toml::node& value, const Range& range) const;
  const toml::array& readArray(const CountRange& count) const;
  [[noreturn]] void reject(const toml::node& culprit) const;
};

}  // namespace patella::app
