#include "firmware_app/files/atomic_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sha2.h>
#include <unistd.h>

namespace patella::app {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

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
  unkept_.create([this] {
    do {
      temporary_ = target_;
      temporary_ += ".partial-" + std::to_string(getpid()) + "-" + std::to_string(serial++);
      descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) {
      fail("cannot be created");
    }
    return temporary_;
  });
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

std::string readFile(const std::filesystem::path& path, const files::FileKind& kind) {
  try {
    return files::readWhole(path, kind);
  } catch (const std::runtime_error& error) {
    throw FileError(error.what());
  }
}

std::string fileSha256(const std::filesystem::path& path) {
  SHA2_CTX context;
  SHA256Init(&context);
  try {
    files::RegularFile file(path);
    std::array<char, 1 << 16> block{};
    while (const std::size_t count = file.read(block)) {
      SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(block.data()), count);
    }
  } catch (const std::runtime_error& error) {
    throw FileError(error.what());
  }
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digest{};
  return SHA256End(&context, digest.data());
}

}  // namespace patella::app
