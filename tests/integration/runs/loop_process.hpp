// `patella run` as a process of its own, with the demonstration's configuration.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tools/checkout/checkout.hpp"
#include "tools/process/process.hpp"

namespace patella::test {

/// Its output goes to the file `said`. `prepare` is called in the new process, right before the program
/// takes its place.
inline pid_t start(std::vector<std::string> arguments, const std::filesystem::path& said,
                   const std::function<void()>& prepare = {}) {
  const std::string config = checkout::source() / "firmware_app/config/adult.toml";
  arguments.insert(arguments.begin(),
                   {checkout::build() / "firmware_app/patella", "run", "--config", config});
  return process::start(arguments, {.output = said}, prepare);
}

/// Exit status, or the signal that ended it, negative.
inline int wait(pid_t child) {
  const process::Ending ending = process::wait(child);
  return ending.signal != 0 ? -ending.signal : ending.exit_status;
}

inline std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace patella::test
