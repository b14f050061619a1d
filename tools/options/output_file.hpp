// A tool does not write over what it reads: a recording is there once.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace patella::options {

/// What the loop leaves in a folder.
inline std::vector<std::filesystem::path> filesOfRun(const std::filesystem::path& run) {
  return {run / "frames.log", run / "ticks.csv", run / "events.log", run / "summary.json"};
}

/// Throws std::invalid_argument where a file to write is one of those that are read, by whatever name.
inline void requireOther(const std::string& option, const std::filesystem::path& output,
                         const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code absent;
    if (std::filesystem::equivalent(output, input, absent)) {
      throw std::invalid_argument(option + ": value '" + output.string() +
                                  "', which is read from, expected another file");
    }
  }
}

}  // namespace patella::options
