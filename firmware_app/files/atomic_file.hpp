// Files appear whole or not at all: what is written goes to a temporary neighbour that takes the target's
// name only when committed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "firmware_app/files/file_error.hpp"

namespace patella::app {

class AtomicFile {
 public:
  /// Opens the temporary file in the folder of `target`. Throws FileError with the path and the system's
  /// reason, also when the target exists and is no regular file.
  explicit AtomicFile(const std::filesystem::path& target);
  /// Removes the temporary file unless committed; the target is then as it was.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view text);
  /// Flushes to the disk and renames; nothing can be written afterwards. Throws FileError.
  void commit();

  const std::filesystem::path& target() const noexcept { return target_; }

 private:
  void flush();
  [[noreturn]] void fail(std::string_view action) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file, atomically. Throws FileError.
void writeFile(const std::filesystem::path& target, std::string_view text);

/// Whole contents of a file. Throws FileError with the path and the system's reason.
std::string readFile(const std::filesystem::path& path);

/// Contents of a file, part by part: for files that are larger than memory should be.
class FileParts {
 public:
  /// Throws FileError with the path and the system's reason.
  explicit FileParts(const std::filesystem::path& path);
  ~FileParts();
  FileParts(const FileParts&) = delete;
  FileParts& operator=(const FileParts&) = delete;

  /// Valid until the next call; empty at the end. Throws FileError.
  std::string_view next();
  /// Bytes of a regular file; 0 where the system does not know.
  std::size_t size() const noexcept { return size_; }

 private:
  std::filesystem::path path_;
  std::string part_;
  std::size_t size_ = 0;
  int descriptor_ = -1;
};

/// SHA-256 of a file as 64 hexadecimal digits, as `sha256sum` prints it: names the exact model, weights and
/// configuration of a run. Throws FileError.
std::string fileSha256(const std::filesystem::path& path);

}  // namespace patella::app
