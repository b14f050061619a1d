// A process that dies leaves no drive with torque: each gets its zero frame and is told to leave.
#include <array>
#include <csignal>
#include <new>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "tests/integration/drives/drive_rig.hpp"
#include "tests/support/fresh_signals.hpp"

using namespace patella;
using namespace patella::test;

namespace {

/// Frames that a process leaves behind, in memory that outlives it.
struct LeftFrames {
  std::size_t count = 0;
  std::array<can::Frame, 256> frames;
};

class LeavingBus final : public can::Bus {
 public:
  explicit LeavingBus(LeftFrames& left) noexcept : left_(left) {}
  std::size_t receive(std::span<can::Frame>, std::int64_t) noexcept PATELLA_NONBLOCKING override { return 0; }
  can::SendResult send(can::Frame& frame, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    if (left_.count == left_.frames.size()) {
      return can::SendResult::kQueueFull;
    }
    left_.frames[left_.count++] = frame;
    return can::SendResult::kSent;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

 private:
  LeftFrames& left_;
};

std::vector<can::Frame> lastFrames(Drives drives, int signal) {
  const ScratchFolder folder;
  const app::RunConfig config = driveConfiguration(drives, 1.0, folder);
  void* memory = mmap(nullptr, sizeof(LeftFrames), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(memory != MAP_FAILED);
  auto* left = new (memory) LeftFrames;
  const pid_t child = fork();
  if (child == 0) {
    useFreshSignals(app::kSignalCount);
    LeavingBus bus(*left);
    can::CommandEncoder encoder = app::makeEncoder(config);
    gpio::SimulatedPins pins;
    const MonotonicClock clock;
    const app::EmergencyExit exit(pins, bus, encoder, clock, 2);
    raise(signal);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  std::vector<can::Frame> frames(left->frames.begin(),
                                 left->frames.begin() + static_cast<std::ptrdiff_t>(left->count));
  munmap(memory, sizeof(LeftFrames));
  return frames;
}

struct Expected {
  std::uint32_t id;
  std::vector<std::uint8_t> data;
  std::uint8_t bus = 0;
};

void checkRounds(const std::vector<can::Frame>& frames, const std::vector<Expected>& round) {
  REQUIRE(frames.size() == 6 * round.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Expected& expected = round[i % round.size()];
    CAPTURE(i);
    CHECK(frames[i].id == expected.id);
    CHECK(frames[i].bus == expected.bus);
    REQUIRE(frames[i].length == expected.data.size());
    CHECK(std::equal(expected.data.begin(), expected.data.end(), frames[i].data.begin()));
  }
}

}  // namespace

TEST_CASE("whoever dies of a fault of its own sends every drive zero torque and the frame to leave by") {
  const std::vector<std::uint8_t> zero = {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x08, 0x00};
  const std::vector<std::uint8_t> leave = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD};
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS}) {
    CAPTURE(signal);
    checkRounds(lastFrames(Drives::kMit, signal), {{1, zero}, {1, leave}, {2, zero}, {2, leave}});
    checkRounds(lastFrames(Drives::kOdrive, signal),
                {{0x2E, {0, 0, 0, 0}}, {0x27, {1, 0, 0, 0}}, {0x4E, {0, 0, 0, 0}}, {0x47, {1, 0, 0, 0}}});
    checkRounds(lastFrames(Drives::kMixed, signal),
                {{1, zero}, {1, leave}, {0x4E, {0, 0, 0, 0}}, {0x47, {1, 0, 0, 0}}});
    // Controlword 0000h, which takes the voltage away, and no torque.
    checkRounds(lastFrames(Drives::kCia402, signal), {{0x201, {0, 0, 0, 0}}, {0x202, {0, 0, 0, 0}}});
    checkRounds(lastFrames(Drives::kTwoBuses, signal), {{0x201, {0, 0, 0, 0}, 0}, {0x202, {0, 0, 0, 0}, 1}});
  }
}

// What SIGKILL or a power failure leaves: no frame more, and the drives as the last one left them.
TEST_CASE("a loop that is killed says nothing more: each drive's own watchdog takes its torque away") {
  for (const auto& [drives, least_s, most_s] :
       {std::tuple{Drives::kMit, 0.018, 0.021}, std::tuple{Drives::kOdrive, 0.018, 0.021},
        std::tuple{Drives::kCia402, 0.002, 0.006}, std::tuple{Drives::kTwoBuses, 0.002, 0.006}}) {
    CAPTURE(static_cast<int>(drives));
    const ScratchFolder folder;
    app::RunConfig config = driveConfiguration(drives, 1.2, folder);
    config.loop.shutdown_frames = 0;
    const DriveRun run = runDrives(config);
    MESSAGE("torque ends ", 1e3 * run.torque_left_s, " ms after the last frame");
    CHECK(run.loop.final_state == safety::State::kActive);
    CHECK(run.torque_left_s > least_s);
    CHECK(run.torque_left_s < most_s);
    const DriveRun asked = runDrives(driveConfiguration(drives, 1.2, folder));
    CHECK(asked.torque_left_s == 0.0);
  }
}

TEST_CASE("a run that is asked to end, as SIGTERM does, disables both drives before it returns") {
  for (const Drives drives : {Drives::kMit, Drives::kOdrive, Drives::kCia402}) {
    const ScratchFolder folder;
    const DriveRun run = runDrives(driveConfiguration(drives, 1.2, folder));
    CHECK(run.loop.final_state == safety::State::kActive);
    CHECK_FALSE(run.enabled[0]);
    CHECK_FALSE(run.enabled[1]);
    CHECK(run.rig.watchdog_trips == 0);
  }
}
