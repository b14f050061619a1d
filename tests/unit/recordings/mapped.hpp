// Small recordings of one joint by a map.
#pragma once

#include <algorithm>
#include <string>

#include "tests/unit/recordings/csv_rows.hpp"

namespace patella::test {

/// Recording of a text by a map; the model has one joint.
inline diagnose::Recording mapped(const std::string& map, const std::string& text) {
  const ScratchFolder folder;
  app::writeFile(folder / "map.toml", map);
  return loaded(text, {.joints = 1, .columns = folder / "map.toml"});
}

/// Message of the exception that this ends with, from the name of the map or the recording on.
inline std::string mappedRefusal(const std::string& map, const std::string& text) {
  const std::string message = messageOf<app::FileError>([&] { mapped(map, text); });
  const auto at = std::min(message.find("map.toml"), message.find("run.csv"));
  return at == std::string::npos ? message : message.substr(at);
}

inline bool warnsOf(const diagnose::Recording& recording, const std::string& text) {
  return std::any_of(recording.warnings.begin(), recording.warnings.end(),
                     [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

}  // namespace patella::test
