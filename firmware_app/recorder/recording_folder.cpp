#include "firmware_app/recorder/recording_folder.hpp"

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>

namespace patella::app {
namespace {

constexpr std::size_t kFileBuffer = 1U << 18;

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& folder, const char* name,
                       std::vector<std::filesystem::path>& created)
    : name_(name), file_(std::fopen((folder / name).c_str(), "wxe")) {
  if (!file_) {
    throw std::runtime_error((folder / name).string() +
                             ": cannot be created: " + std::generic_category().message(errno));
  }
  created.push_back(folder / name);
  std::setvbuf(file_.get(), nullptr, _IOFBF, kFileBuffer);
}

void OutputFile::write(const char* text, std::size_t length) {
  if (error_.empty() && std::fwrite(text, 1, length, file_.get()) != length) {
    fail();
  }
}

void OutputFile::flush() {
  if (error_.empty() && std::fflush(file_.get()) != 0) {
    fail();
  }
}

void OutputFile::fail() {
  error_ = name_ + ": " + std::generic_category().message(errno);
}

void requireNoRecording(const std::filesystem::path& folder) {
  std::vector<const char*> names(kRecordingFiles.begin(), kRecordingFiles.end());
  names.push_back("summary.json");
  std::error_code ignored;
  for (const char* name : names) {
    if (std::filesystem::exists(folder / name, ignored)) {
      throw std::runtime_error(folder.string() + ": holds a recording already (" + name +
                               "), expected a new or empty folder");
    }
  }
}

std::uint64_t freeBytes(std::filesystem::path folder) {
  std::error_code error;
  while (!folder.empty() && !std::filesystem::exists(folder, error) && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  const auto space = std::filesystem::space(folder.empty() ? "." : folder, error);
  return error ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

void requireRoom(const RecorderOptions& options) {
  const std::uint64_t available = freeBytes(options.folder);
  if (available < options.min_free_bytes) {
    throw std::runtime_error(options.folder.string() + ": " + std::to_string(available / 1'000'000) +
                             " MB are free on its disk, expected at least " +
                             std::to_string(options.min_free_bytes / 1'000'000) + " (loop.min_free_MB)");
  }
}

std::vector<std::filesystem::path> missingFolders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> missing;
  std::error_code error;
  for (auto path = folder; !path.empty() && !std::filesystem::exists(path, error) && path != path.root_path();
       path = path.parent_path()) {
    missing.insert(missing.begin(), path);
  }
  return missing;
}

}  // namespace patella::app
