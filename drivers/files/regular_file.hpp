// Files from outside, read with bounds: a name that leads to a device, a pipe or gigabytes is refused in
// words before anything is taken from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace patella::files {

/// Kind of a file, and the most bytes that it may have. Recordings are read line by line, by LineReader, and
/// have no ceiling.
struct FileKind {
  const char* what;
  std::uint64_t most_bytes;
};

/// Run configurations, models, maps, scripts of faults: written by hand, the longest shipped has 5 kB; a
/// megabyte is parsed in well under two seconds.
inline constexpr FileKind kConfigurationFile{"a configuration", 1'000'000};
/// The bus of a whole vehicle takes a few megabytes.
inline constexpr FileKind kBusDescription{"a bus description", 16'000'000};
/// CANopen data sheets; those of drives have some hundred kilobytes.
inline constexpr FileKind kDataSheet{"a data sheet", 4'000'000};
/// The usual network takes 0.4 MB; one of 64 MB would not fit into a tick.
inline constexpr FileKind kWeightsFile{"weights", 64'000'000};
/// Weights, the best of them so far, and two moments of each.
inline constexpr FileKind kCheckpoint{"a checkpoint", 256'000'000};
/// Summaries and results that Patella itself wrote.
inline constexpr FileKind kResultFile{"a file of results", 64'000'000};

/// A regular file, opened for reading. Failures are std::runtime_error with path, what is there and what was
/// expected.
class RegularFile {
 public:
  explicit RegularFile(const std::filesystem::path& path);
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  /// Bytes when it was opened.
  std::uint64_t size() const noexcept { return size_; }
  /// Fills `out` from the start on, less only at the end of the file. Returns the number of bytes.
  std::size_t read(std::span<char> out);
  const std::string& name() const noexcept { return name_; }

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// All of a file that is no longer than its kind may be.
std::string readWhole(const std::filesystem::path& path, const FileKind& kind);

}  // namespace patella::files
