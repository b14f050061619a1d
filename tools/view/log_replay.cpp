#include "tools/view/log_replay.hpp"

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tools/process/process.hpp"

namespace patella::view {
namespace {

/// What a program said, without its name before it and the end of the line behind it.
std::string bare(std::string said) {
  constexpr std::string_view kName = "patella: ";
  said.erase(0, said.starts_with(kName) ? kName.size() : 0);
  said.erase(said.find_last_not_of(" \r\n") + 1);
  return said;
}

}  // namespace

LogReplay::LogReplay(const std::filesystem::path& log, const std::filesystem::path& configuration) {
  if (configuration.empty()) {
    throw app::FileError(log.string() +
                         ": is a file, expected the folder of a run, or a log of frames with --config and "
                         "the configuration of the loop that it is played to");
  }
  std::error_code error;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "patella";
  const std::filesystem::path said = temporary_ / "output";
  const auto ending = process::wait(process::start(
      {beside.string(), "run", "--config", configuration.string(), "--backend", "replay:" + log.string(),
       "--clock", "virtual", "--duration", "0", "--out", folder().string()},
      {.output = said}));
  if (ending.exit_status != 0) {
    throw app::FileError(log.string() + ": cannot be played: " + bare(app::readFile(said)));
  }
}

}  // namespace patella::view
