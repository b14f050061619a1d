// A log is played or refused; of one that is played, each frame is given or is a recorded command, but for a
// last line that was cut.
#include <array>
#include <optional>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/replay_bus.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace {

using namespace patella;

struct Count {
  std::size_t frames = 0;
  std::size_t cut_line = 0;
};

std::optional<Count> countFrames(const std::filesystem::path& path) {
  try {
    can::CandumpReader reader(path);
    can::LogEntry entry;
    Count count;
    while (reader.next(entry))
      ++count.frames;
    count.cut_line = reader.cutLine();
    return count;
  } catch (const can::LogError&) {
    return std::nullopt;
  }
}

void play(can::ReplayBus& bus, const Count& in_log) {
  constexpr std::int64_t kStep_ns = 1'000'000'000;
  std::array<can::Frame, 3> frames;
  std::size_t played = 0;
  std::int64_t now_ns = 0;
  const std::size_t most_steps = 100 * (in_log.frames + 2);  // a gap is no longer than 60 s
  for (std::size_t step = 0; !bus.exhausted(); ++step, now_ns += kStep_ns) {
    fuzz::require(step < most_steps, "a log that is played comes to its end");
    played += bus.receive(frames, now_ns);
  }
  const std::size_t cut = bus.cutLine() != in_log.cut_line ? 1 : 0;
  fuzz::require(played == bus.playedFrames() && played == bus.frames(), "frames that are given are counted");
  fuzz::require(played + bus.recordedCommands() + cut == in_log.frames, "no frame of the log is lost");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(fuzz::text(data, size));
  const std::optional<Count> in_log = countFrames(file.path());
  try {
    can::ReplayBus bus(file.path(), {.command_id = 0x80});
    fuzz::require(in_log.has_value(), "what cannot be read is not played");
    play(bus, *in_log);
  } catch (const can::LogError&) {
    // refused with line
  }
  return 0;
}
