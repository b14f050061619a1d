// The newest messages of a run in shared memory: one process writes, any number map it read-only. The writer
// never looks at a reader, so that none can hold it up or be told anything by it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/types.hpp"

namespace patella::live {

/// Bytes of messages that the ring holds: about four seconds of a 1 kHz loop with seven frames a tick.
inline constexpr std::size_t kRingBytes = 4U << 20;
/// Longest message that is taken.
inline constexpr std::size_t kLongestMessage = 1U << 16;
/// Room for the description of the run.
inline constexpr std::size_t kDescriptionBytes = 1U << 16;

struct LiveMessage {
  std::uint16_t channel = 0;
  std::uint64_t wall_ns = 0;
  std::string data;
};

/// Name of the shared memory of a run that is recorded into a folder, as shm_open(3) takes it.
std::string ringName(const std::filesystem::path& run_folder);

/// Takes away what runs that died left in shared memory: each is a few megabytes until the next start of the
/// machine. What a living process writes, or another user owns, stays.
void removeLeftRings();

class RingWriter {
 public:
  /// Makes the shared memory, readable by the same user only, in place of what a run before left under the
  /// name. `description`: text for readers. Throws std::runtime_error with the system's reason, or where it
  /// is too long.
  RingWriter(const std::string& name, std::string_view description);
  /// Tells readers that the run has ended, and takes the name away; who has it mapped keeps it.
  ~RingWriter();
  RingWriter(const RingWriter&) = delete;
  RingWriter& operator=(const RingWriter&) = delete;

  /// Overwrites the oldest messages. One that is longer than kLongestMessage is left out.
  void write(std::uint16_t channel, std::uint64_t wall_ns, std::string_view data) noexcept;

 private:
  struct Memory;
  std::string name_;
  int file_ = -1;  // locked as long as the writer lives
  Memory* memory_ = nullptr;
};

class RingReader {
 public:
  /// Maps the ring of a run, and begins with the message that comes next. Throws std::runtime_error where
  /// there is none, or one of another version.
  explicit RingReader(const std::string& name);
  ~RingReader();
  RingReader(const RingReader&) = delete;
  RingReader& operator=(const RingReader&) = delete;

  const std::string& description() const noexcept { return description_; }
  /// The next message; false where there is none yet. A reader that is too late goes on with the newest.
  bool next(LiveMessage& message);
  /// Times that it was too late.
  std::uint64_t overruns() const noexcept { return overruns_; }
  /// Process of the run.
  int writer() const noexcept;
  /// The writer has said that the run is over, or is there no more.
  bool ended() const noexcept;

 private:
  struct Memory;
  bool catchUp() noexcept;

  const Memory* memory_ = nullptr;
  std::string description_;
  std::uint64_t at_ = 0;
  std::uint64_t overruns_ = 0;
};

}  // namespace patella::live
