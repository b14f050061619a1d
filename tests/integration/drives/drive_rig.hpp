// The demonstration's leg on two drives as they are sold, with a hand on the bus between them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/gpio/pins.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/simulated_bus.hpp"
#include "tests/support/scratch_folder.hpp"

namespace patella::test {

enum class Drives { kBuiltIn, kMit, kOdrive, kMixed, kCia402, kTwoBuses };

inline constexpr double kEnableAt_s = 0.5;

/// The demonstration with these drives, each joint with its own, in virtual time. Mixed: joint 1 in MIT mode,
/// joint 2 on an ODrive. CiA 402: set up when they are run; on two buses, "hip" and "knee", each with a
/// drive, the latter with EMG and operator. Files are left in `folder`.
app::RunConfig driveConfiguration(Drives drives, double duration_s, const ScratchFolder& folder);

/// Sends through to the rig, but for frames that the test keeps back; notes down what the loop sent.
class WatchedBus final : public can::Bus {
 public:
  WatchedBus(sim::Rig& rig, Clock& clock, const gpio::SimulatedPins& pins)
      : bus_(rig, clock), clock_(clock), pins_(pins) {}
  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    ++tick;
    line_up = pins_.driveEnable();
    const std::size_t count = bus_.receive(frames, now_ns);
    for (std::size_t i = 0; i < count; ++i) {
      frames[i].error = frames[i].error || (drop && drop(frames[i]));
      if (rename) {
        rename(frames[i]);
      }
    }
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    const bool kept = keep_back && keep_back(frame);
    if (!kept) {
      note(frame);
    }
    return kept ? can::SendResult::kQueueFull : bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusSet downBuses() const noexcept override { return bus_.downBuses(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }
  can::BusStatistics statisticsOf(std::size_t bus) const noexcept override { return bus_.statisticsOf(bus); }
  /// The loop is kept from running for so long, wherever it is.
  void stall(std::int64_t span_ns) noexcept { clock_.sleepUntil(clock_.now() + span_ns); }

  std::function<bool(const can::Frame&)> keep_back;
  /// Of what comes: frames that the loop does not hear, and frames that come as others.
  std::function<bool(const can::Frame&)> drop;
  std::function<void(can::Frame&)> rename;
  /// Frames that went out in the tick `watched_tick`.
  std::vector<can::Frame> seen;
  int watched_tick = -1;
  int tick = -1;
  bool line_up = false;  ///< as the tick before has left it

 private:
  void note(const can::Frame& frame) noexcept {
    if (tick == watched_tick && seen.size() < seen.capacity()) {
      seen.push_back(frame);
    }
  }
  sim::SimulatedBus bus_;
  Clock& clock_;
  const gpio::SimulatedPins& pins_;
};

/// What a run left behind.
struct DriveRun {
  app::LoopStatistics loop;
  can::BusStatistics bus;
  sim::RigStatistics rig;
  std::uint64_t unused_frames = 0;  ///< of the drives: refused for whatever reason, or late
  std::vector<std::uint64_t> commands;
  std::vector<bool> enabled;
  std::vector<can::Frame> seen;  ///< as WatchedBus has it
  double torque_left_s = 0.0;    ///< from the loop's last frame until no drive gives torque; 1 s: never
  bool line_up_in_run = false;   ///< as the last tick but one has left it
  bool line_up = false;          ///< after the run
  double tracking_rad(std::size_t joint) const;
};

/// `prepare` is called before the run.
DriveRun runDrives(const app::RunConfig& config, const std::function<void(WatchedBus&)>& prepare = {});

}  // namespace patella::test
