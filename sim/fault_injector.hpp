// Acts out the rig's part of a fault script: on sensors, on drives, and on frames in both directions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "sim/drive.hpp"
#include "sim/fault_script.hpp"
#include "sim/field_drive.hpp"
#include "sim/frame_forger.hpp"
#include "sim/random.hpp"

namespace patella::sim {

/// Deterministic in (events, seed) and the calls made to it.
class FaultInjector {
 public:
  /// Frames that delays and stalls may hold back at one time; what exceeds it is lost.
  static constexpr std::size_t kMaxHeld = 4096;

  /// Events that act on the loop are passed over. Throws std::invalid_argument for an event out of range.
  FaultInjector(const std::vector<FaultEvent>& events, const can::Database& database, std::uint64_t seed);

  /// To be called at each sample with the time since the rig's start, before anything else.
  void advance(double time_s) noexcept PATELLA_NONBLOCKING;
  bool active(FaultKind kind) const noexcept { return find(kind) != nullptr; }
  /// Buses that it strikes.
  can::BusSet struck(FaultKind kind) const noexcept;
  /// In the newest advance().
  bool began(FaultKind kind) const noexcept { return changed(kind, true) != 0; }
  bool ended(FaultKind kind) const noexcept { return changed(kind, false) != 0; }
  /// The buses of it.
  can::BusSet beganOn(FaultKind kind) const noexcept { return changed(kind, true); }
  can::BusSet endedOn(FaultKind kind) const noexcept { return changed(kind, false); }

  void encoder(int joint, double& position_rad, double& velocity_rad_s) noexcept PATELLA_NONBLOCKING;
  void emg(EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING;
  DriveDisturbance drive() noexcept PATELLA_NONBLOCKING;
  /// The same and more for a drive that is a node of its own.
  FieldDriveDefect fieldDrive(int joint) noexcept PATELLA_NONBLOCKING;
  /// Wall-clock steps that are in force, ns.
  std::int64_t wallStep_ns() const noexcept;

  /// Hands on to sink(frame) what becomes of a frame right now: nothing, itself, or more.
  template <typename Sink>
  void pass(can::Frame frame, FrameChannel channel, Sink&& sink) noexcept {
    if (!events_.empty()) {
      forger_.heard(frame, channel);
    }
    if (idle()) {
      sink(frame);
      return;
    }
    if (silent(frame.bus) || lost(frame, channel)) {
      return;
    }
    flip(frame, channel);
    if (hold(frame, channel)) {
      return;
    }
    const auto index = static_cast<int>(channel);
    std::optional<can::Frame>& waiting = reordered_[static_cast<std::size_t>(channel)];
    if (FaultEvent* event = find(FaultKind::kReorderedFrames, index, frame.bus);
        event != nullptr && !waiting && happens(*event)) {
      waiting = frame;
      return;
    }
    sink(frame);
    if (const FaultEvent* event = find(FaultKind::kDuplicatedFrames, index, frame.bus);
        event != nullptr && happens(*event)) {
      sink(frame);
    }
    if (waiting) {
      sink(*std::exchange(waiting, std::nullopt));
    }
  }

  /// Hands on to sink(frame, channel) what was held back until now; while the bus is silent it is lost.
  template <typename Sink>
  void release(Sink&& sink) noexcept {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < held_count_; ++i) {
      if (held_[i].due_s > time_s_) {
        held_[kept++] = held_[i];
      } else if (!silent(held_[i].frame.bus)) {
        sink(held_[i].frame, held_[i].channel);
      }
    }
    held_count_ = kept;
  }

  /// Hands on to sink(frame, channel) the forged frames of this sample; while the bus is silent there are
  /// none.
  template <typename Sink>
  void forge(Sink&& sink) noexcept {
    for (int i = 0; i < kFrameChannelCount; ++i) {
      const FaultEvent* event = find(FaultKind::kForgedFrames, i);
      const auto channel = static_cast<FrameChannel>(i);
      if (event == nullptr || !happens(*event)) {
        continue;
      }
      const auto frame = forger_.forge(channel, event->value, event->counter_correct, event->crc_correct);
      if (frame && !silent(frame->bus) && event->strikes(frame->bus)) {
        sink(*frame, channel);
      }
    }
  }

  /// Time at which each event first did something, s since the start; negative while it has not. In the order
  /// of the rig's events.
  const std::vector<double>& firstEffects_s() const noexcept { return first_effect_s_; }
  const std::vector<FaultEvent>& events() const noexcept { return events_; }

 private:
  struct Held {
    can::Frame frame;
    FrameChannel channel = FrameChannel::kEncoder1;
    double due_s = 0.0;
  };

  bool idle() const noexcept { return active_count_ == 0 && held_count_ == 0 && !waiting(); }
  bool waiting() const noexcept;
  bool silent(std::uint8_t bus) const noexcept;
  can::BusSet changed(FaultKind kind, bool to) const noexcept;
  const FaultEvent* find(FaultKind kind) const noexcept;
  FaultEvent* find(FaultKind kind, int channel, int bus = FaultEvent::kAll) noexcept;
  bool acts(FaultKind kind, int channel) noexcept;
  /// Draws for one frame, and notes the first time.
  bool happens(const FaultEvent& event) noexcept;
  void note(const FaultEvent& event) noexcept;
  bool lost(const can::Frame& frame, FrameChannel channel) noexcept;
  void flip(can::Frame& frame, FrameChannel channel) noexcept;
  bool hold(const can::Frame& frame, FrameChannel channel) noexcept;

  std::vector<FaultEvent> events_;
  std::vector<bool> active_, before_;
  std::vector<double> first_effect_s_;
  FrameForger forger_;
  Random random_;
  double time_s_ = 0.0;
  std::size_t active_count_ = 0;
  std::vector<Held> held_;
  std::size_t held_count_ = 0;
  std::array<std::optional<can::Frame>, kFrameChannelCount> reordered_;
  std::array<std::optional<std::pair<double, double>>, kMaxJoints> frozen_;
};

}  // namespace patella::sim
