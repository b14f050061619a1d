// Files appear whole or not at all: what is written goes to a temporary neighbour that takes the target's
// name only when committed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/files/interruption.hpp"
#include "drivers/files/regular_file.hpp"
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
  /// Where it is until committed: for a library that writes by name, in place of write().
  const std::filesystem::path& temporary() const noexcept { return temporary_; }

 private:
  void flush();
  [[noreturn]] void fail(std::string_view action) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  files::UnkeptPath unkept_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file, atomically. Throws FileError.
void writeFile(const std::filesystem::path& target, std::string_view text);

/// Whole contents of a regular file. Throws FileError with the path and the system's reason, what is there
/// instead, or the length where it is more than a file of that kind has.
std::string readFile(const std::filesystem::path& path,
                     const files::FileKind& kind = files::kConfigurationFile);

/// SHA-256 of a file as 64 hexadecimal digits, as `sha256sum` prints it: names the exact model, weights and
/// configuration of a run. The file may have any length. Throws FileError as readFile() does.
std::string fileSha256(const std::filesystem::path& path);

}  // namespace patella::app
