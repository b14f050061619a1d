#include "firmware_app/commands/view_command.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "firmware_app/files/standard_streams.hpp"

namespace patella::app {

int becomeViewer(char** arguments) {
  constexpr const char* kProgram = "patella-view";
  std::error_code error;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / kProgram;
  execv(beside.c_str(), arguments);
  execvp(kProgram, arguments);
  show(stderr, fmt::format("patella: {}: {}\n", beside.string(), std::generic_category().message(errno)));
  return 1;
}

}  // namespace patella::app
