#include "firmware_app/live/live_ring.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace patella::live {
namespace {

constexpr std::uint64_t kMagic = 0x31455649'4C544150;  // "PATLIVE1"
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kWord = sizeof(std::uint64_t);
constexpr std::size_t kWords = kRingBytes / kWord;
/// Where Linux shows what shm_open(3) names.
const std::string kSharedMemory = "/dev/shm";
const std::string kNameStart = "/patella-";
constexpr std::size_t kHeadWords = 2;  // channel and length, wall time

using Word = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == kWord, "words are shared between processes");

std::size_t wordsOf(std::size_t bytes) {
  return kHeadWords + (bytes + kWord - 1) / kWord;
}

bool isGone(int process) {
  return kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

// A message lies between two positions that count words since the beginning. `reserved` moves before its
// words are written and `committed` after: what a reader has copied is sound where `reserved` has not come
// round to it since.
struct RingLayout {
  Word magic;
  std::atomic<std::uint32_t> version;
  std::atomic<std::int32_t> writer;
  Word reserved;
  Word committed;
  Word ended;
  Word description_bytes;
  std::array<char, kDescriptionBytes> description;
  std::array<Word, kWords> words;
};
struct RingWriter::Memory : RingLayout {};
struct RingReader::Memory : RingLayout {};

namespace {

/// How the memory of every version begins.
struct Head {
  std::uint64_t magic;
  std::uint32_t version;
  std::int32_t writer;
};
static_assert(offsetof(RingLayout, version) == offsetof(Head, version) &&
              offsetof(RingLayout, writer) == offsetof(Head, writer));

/// The number alone does not tell of a writer in another container, whose lock does. The magic comes after
/// the lock, so that a ring that is being made is none of a dead run.
bool isOfADeadRun(int file) {
  Head head{};
  return pread(file, &head, sizeof(head), 0) == static_cast<ssize_t>(sizeof(head)) && head.magic == kMagic &&
         head.writer > 0 && isGone(head.writer) && flock(file, LOCK_EX | LOCK_NB) == 0;
}

/// A new run may have taken the name meanwhile.
bool isStillNamed(int file, const std::string& name) {
  struct stat opened {};
  struct stat named {};
  return fstat(file, &opened) == 0 && stat((kSharedMemory + name).c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino;
}

}  // namespace

void removeLeftRings() {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(kSharedMemory, none)) {
    const std::string name = "/" + entry.path().filename().string();
    if (!name.starts_with(kNameStart)) {
      continue;
    }
    const int file = shm_open(name.c_str(), O_RDONLY | O_CLOEXEC, 0);
    if (file < 0) {
      continue;  // another user's
    }
    if (isOfADeadRun(file) && isStillNamed(file, name)) {
      shm_unlink(name.c_str());
    }
    close(file);
  }
}

std::string ringName(const std::filesystem::path& run_folder) {
  // FNV-1a: names need to differ, not to hide.
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : std::filesystem::weakly_canonical(std::filesystem::absolute(run_folder)).string()) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return kNameStart + std::string(text.data());
}

RingWriter::RingWriter(const std::string& name, std::string_view description) : name_(name) {
  if (description.size() > kDescriptionBytes) {
    throw std::runtime_error("a description of " + std::to_string(description.size()) +
                             " bytes, expected at most " + std::to_string(kDescriptionBytes));
  }
  shm_unlink(name.c_str());
  file_ = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const auto fail = [&](int error) {
    throw std::runtime_error("shared memory " + name + ": " + std::generic_category().message(error));
  };
  if (file_ < 0) {
    fail(errno);
  }
  flock(file_, LOCK_EX);
  // All of it now: a full /dev/shm is told of here, and not by a signal later.
  const int no_room = posix_fallocate(file_, 0, sizeof(Memory));
  void* at =
      no_room == 0 ? mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0) : MAP_FAILED;
  const int error = no_room != 0 ? no_room : errno;
  if (at == MAP_FAILED) {
    close(file_);
    shm_unlink(name.c_str());
    fail(error);
  }
  memory_ = new (at) Memory;
  std::copy(description.begin(), description.end(), memory_->description.begin());
  memory_->description_bytes.store(description.size(), std::memory_order_relaxed);
  memory_->version.store(kVersion, std::memory_order_relaxed);
  memory_->writer.store(getpid(), std::memory_order_relaxed);
  memory_->magic.store(kMagic, std::memory_order_release);
}

RingWriter::~RingWriter() {
  memory_->ended.store(1, std::memory_order_release);
  shm_unlink(name_.c_str());
  munmap(memory_, sizeof(Memory));
  close(file_);
}

void RingWriter::write(std::uint16_t channel, std::uint64_t wall_ns, std::string_view data) noexcept {
  if (data.size() > kLongestMessage) {
    return;
  }
  const std::uint64_t start = memory_->committed.load(std::memory_order_relaxed);
  const std::uint64_t end = start + wordsOf(data.size());
  memory_->reserved.store(end, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  std::uint64_t at = start;
  const auto put = [&](std::uint64_t word) {
    memory_->words[at++ % kWords].store(word, std::memory_order_relaxed);
  };
  put(static_cast<std::uint64_t>(channel) << 32U | data.size());
  put(wall_ns);
  for (std::size_t i = 0; i < data.size(); i += kWord) {
    std::uint64_t word = 0;
    std::memcpy(&word, data.data() + i, std::min(kWord, data.size() - i));
    put(word);
  }
  memory_->committed.store(end, std::memory_order_release);
}

RingReader::RingReader(const std::string& name) {
  const int file = shm_open(name.c_str(), O_RDONLY | O_CLOEXEC, 0);
  if (file < 0) {
    throw std::runtime_error("shared memory " + name + ": " + std::generic_category().message(errno));
  }
  struct stat status {};
  const bool whole = fstat(file, &status) == 0 && status.st_size == static_cast<off_t>(sizeof(Memory));
  void* at = whole ? mmap(nullptr, sizeof(Memory), PROT_READ, MAP_SHARED, file, 0) : MAP_FAILED;
  close(file);
  if (at == MAP_FAILED) {
    throw std::runtime_error("shared memory " + name + ": is not that of a run of this version");
  }
  memory_ = static_cast<const Memory*>(at);
  const std::uint64_t length = memory_->description_bytes.load(std::memory_order_relaxed);
  if (memory_->magic.load(std::memory_order_acquire) != kMagic ||
      memory_->version.load(std::memory_order_relaxed) != kVersion || length > kDescriptionBytes) {
    munmap(at, sizeof(Memory));
    throw std::runtime_error("shared memory " + name + ": is not that of a run of this version");
  }
  description_.assign(memory_->description.data(), static_cast<std::size_t>(length));
  at_ = memory_->committed.load(std::memory_order_acquire);
}

RingReader::~RingReader() {
  munmap(const_cast<Memory*>(memory_),
         sizeof(Memory));  // NOLINT(cppcoreguidelines-pro-type-const-cast): munmap(2)
}

bool RingReader::catchUp() noexcept {
  ++overruns_;
  at_ = memory_->committed.load(std::memory_order_acquire);
  return false;
}

bool RingReader::next(LiveMessage& message) {
  const std::uint64_t committed = memory_->committed.load(std::memory_order_acquire);
  if (committed == at_) {
    return false;
  }
  if (committed - at_ > kWords) {
    return catchUp();
  }
  std::uint64_t at = at_;
  const auto get = [&] { return memory_->words[at++ % kWords].load(std::memory_order_relaxed); };
  const std::uint64_t head = get();
  const std::size_t length = head & 0xFFFF'FFFFU;
  // Words that are being overwritten may say anything.
  if (length > kLongestMessage || wordsOf(length) > committed - at_) {
    return catchUp();
  }
  message.channel = static_cast<std::uint16_t>(head >> 32U);
  message.wall_ns = get();
  message.data.resize(length);
  for (std::size_t i = 0; i < length; i += kWord) {
    const std::uint64_t word = get();
    std::memcpy(message.data.data() + i, &word, std::min(kWord, length - i));
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  if (memory_->reserved.load(std::memory_order_relaxed) - at_ > kWords) {
    return catchUp();
  }
  at_ = at;
  return true;
}

int RingReader::writer() const noexcept {
  return memory_->writer.load(std::memory_order_relaxed);
}

bool RingReader::ended() const noexcept {
  return memory_->ended.load(std::memory_order_acquire) != 0 || isGone(writer());
}

}  // namespace patella::live
