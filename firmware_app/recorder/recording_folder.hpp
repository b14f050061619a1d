// The folder that a run is recorded in: what may be there before, its files and the room on its disk.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware_app/recorder/recorder_options.hpp"

namespace patella::app {

inline constexpr std::array kRecordingFiles = {"frames.log", "ticks.csv", "events.log", "run.mcap"};

/// One output file; remembers the first failure and writes nothing after it.
class OutputFile {
 public:
  /// Adds itself to `created`. Throws std::runtime_error where it is there already or cannot be created.
  OutputFile(const std::filesystem::path& folder, const char* name,
             std::vector<std::filesystem::path>& created);

  void write(const char* text, std::size_t length);
  void flush();
  const std::string& error() const noexcept { return error_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  void fail();

  std::string name_;
  std::string error_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Throws std::runtime_error where the folder holds a recording.
void requireNoRecording(const std::filesystem::path& folder);

/// Bytes that may still be written where the folder is, or will be; the largest number where nobody can tell.
std::uint64_t freeBytes(std::filesystem::path folder);

/// Throws std::runtime_error where less than options.min_free_bytes are free.
void requireRoom(const RecorderOptions& options);

/// The folder and those above it that are not there, outermost first.
std::vector<std::filesystem::path> missingFolders(const std::filesystem::path& folder);

}  // namespace patella::app
