#include "drivers/files/regular_file.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace patella::files {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& problem) {
  throw std::runtime_error(name + ": " + problem);
}

std::string because(int error) {
  return ": " + std::generic_category().message(error);
}

const char* kindOf(mode_t mode) {
  return S_ISDIR(mode)    ? "a directory"
         : S_ISFIFO(mode) ? "a pipe"
         : S_ISCHR(mode)  ? "a character device"
         : S_ISBLK(mode)  ? "a block device"
         : S_ISSOCK(mode) ? "a socket"
                          : "of another kind";
}

void requireRegular(const std::string& name, mode_t mode) {
  if (!S_ISREG(mode))
    fail(name, std::string("is ") + kindOf(mode) + ", expected a regular file");
}

}  // namespace

RegularFile::RegularFile(const std::filesystem::path& path) : name_(path.string()) {
  struct stat status {};
  // Looked at first, as opening a device may already do something; and again, as the name may have changed.
  if (stat(path.c_str(), &status) != 0)
    fail(name_, "cannot be opened" + because(errno));
  requireRegular(name_, status.st_mode);
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0)
    fail(name_, "cannot be opened" + because(errno));
  const bool known = fstat(descriptor_, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    close(descriptor_);
    requireRegular(name_, known ? status.st_mode : 0);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

RegularFile::~RegularFile() {
  close(descriptor_);
}

std::size_t RegularFile::read(std::span<char> out) {
  std::size_t filled = 0;
  while (filled < out.size()) {
    const ssize_t count = ::read(descriptor_, out.data() + filled, out.size() - filled);
    if (count == 0)
      break;
    if (count < 0 && errno != EINTR)
      fail(name_, "cannot be read" + because(errno));
    filled += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  return filled;
}

std::string readWhole(const std::filesystem::path& path, const FileKind& kind) {
  RegularFile file(path);
  const auto refuse = [&](const std::string& length) {
    fail(file.name(), "is " + length + " bytes long, expected at most " + std::to_string(kind.most_bytes) +
                          " of " + kind.what);
  };
  if (file.size() > kind.most_bytes)
    refuse(std::to_string(file.size()));
  // One byte more than there should be: files of the kernel's have no size before they are read.
  constexpr std::uint64_t kBlock = 1 << 16;
  std::string text;
  std::size_t count = 0;
  std::uint64_t wanted = file.size() + 1;
  do {
    const std::size_t before = text.size();
    text.resize(before + static_cast<std::size_t>(wanted));
    count = file.read({text.data() + before, static_cast<std::size_t>(wanted)});
    text.resize(before + count);
    if (text.size() > kind.most_bytes)
      refuse("more than " + std::to_string(kind.most_bytes));
    wanted = std::min(kBlock, kind.most_bytes + 1 - text.size());
  } while (count != 0);
  return text;
}

}  // namespace patella::files
