#include "firmware_app/files/atomic_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sha2.h>
#include <sys/stat.h>
#include <unistd.h>

namespace patella::app {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;
constexpr std::size_t kPartBytes = std::size_t{1} << 18;

std::string because(int error) {
  return ": " + std::generic_category().message(error);
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(target) {
  std::error_code ignored;
  if (std::filesystem::exists(target_, ignored)) {
    if (!std::filesystem::is_regular_file(target_, ignored)) {
      throw FileError(target.string() + ": cannot be replaced, expected a regular file or a new name");
    }
    // A link stays a link: what it points at is replaced.
    target_ = std::filesystem::canonical(target_, ignored);
  }
  static std::atomic<unsigned> serial{0};
  do {
    temporary_ = target_;
    temporary_ += ".partial-" + std::to_string(getpid()) + "-" + std::to_string(serial++);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) {
    fail("cannot be created");
  }
  buffer_.reserve(kBufferBytes);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) {
    close(descriptor_);
    unlink(temporary_.c_str());
  }
}

void AtomicFile::write(std::string_view text) {
  buffer_.append(text);
  if (buffer_.size() >= kBufferBytes) {
    flush();
  }
}

void AtomicFile::commit() {
  flush();
  if (fsync(descriptor_) != 0) {
    fail("cannot be written");
  }
  const int descriptor = std::exchange(descriptor_, -1);
  if (close(descriptor) != 0 || rename(temporary_.c_str(), target_.c_str()) != 0) {
    const int error = errno;
    unlink(temporary_.c_str());
    errno = error;
    fail("cannot be put in place");
  }
}

void AtomicFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno != EINTR) {
      fail("cannot be written");
    }
    rest.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
  buffer_.clear();
}

void AtomicFile::fail(std::string_view action) const {
  throw FileError(target_.string() + ": " + std::string(action) + because(errno));
}

void writeFile(const std::filesystem::path& target, std::string_view text) {
  AtomicFile file(target);
  file.write(text);
  file.commit();
}

FileParts::FileParts(const std::filesystem::path& path)
    : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw FileError(path.string() + ": cannot be opened" + because(errno));
  }
  struct stat status {};
  if (fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::size_t>(status.st_size);
  }
  part_.resize(kPartBytes);
}

FileParts::~FileParts() {
  close(descriptor_);
}

std::string_view FileParts::next() {
  for (;;) {
    const ssize_t count = read(descriptor_, part_.data(), part_.size());
    if (count >= 0) {
      return std::string_view(part_).substr(0, static_cast<std::size_t>(count));
    }
    if (errno != EINTR) {
      throw FileError(path_.string() + ": cannot be read" + because(errno));
    }
  }
}

std::string readFile(const std::filesystem::path& path) {
  FileParts parts(path);
  std::string text;
  text.reserve(parts.size() + 1);
  for (std::string_view part = parts.next(); !part.empty(); part = parts.next()) {
    text.append(part);
  }
  return text;
}

std::string fileSha256(const std::filesystem::path& path) {
  FileParts parts(path);
  SHA2_CTX context;
  SHA256Init(&context);
  for (std::string_view part = parts.next(); !part.empty(); part = parts.next()) {
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
  }
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digest{};
  SHA256End(&context, digest.data());
  return digest.data();
}

}  // namespace patella::app
