#include "sim/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/random_streams.hpp"

namespace patella::sim {

FaultInjector::FaultInjector(const std::vector<FaultEvent>& events, const can::Database& database,
                             std::uint64_t seed)
    : forger_(database), random_(seed, kFaultStream) {
  for (const FaultEvent& event : events) {
    requireSound(event);
    if (!actsOnLoop(event.kind) || event.kind == FaultKind::kClockStep) {
      events_.push_back(event);
    }
  }
  active_.resize(events_.size());
  before_.resize(events_.size());
  first_effect_s_.assign(events_.size(), -1.0);
  held_.resize(events_.empty() ? 0 : kMaxHeld);
}

void FaultInjector::advance(double time_s) noexcept PATELLA_NONBLOCKING {
  time_s_ = time_s;
  active_count_ = 0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    before_[i] = active_[i];
    active_[i] = events_[i].activeAt(time_s);
    active_count_ += active_[i] ? 1U : 0U;
    if (active_[i] && channelGroup(events_[i].kind) == ChannelGroup::kNone) {
      note(events_[i]);
    }
  }
}

namespace {

can::BusSet busesOf(const FaultEvent& event) noexcept {
  return event.bus == FaultEvent::kAll ? can::kAllBuses : can::busBit(static_cast<std::size_t>(event.bus));
}

}  // namespace

can::BusSet FaultInjector::changed(FaultKind kind, bool to) const noexcept {
  can::BusSet buses = 0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (events_[i].kind == kind && active_[i] == to && before_[i] != to) {
      buses = static_cast<can::BusSet>(buses | busesOf(events_[i]));
    }
  }
  return buses;
}

can::BusSet FaultInjector::struck(FaultKind kind) const noexcept {
  can::BusSet buses = 0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (active_[i] && events_[i].kind == kind) {
      buses = static_cast<can::BusSet>(buses | busesOf(events_[i]));
    }
  }
  return buses;
}

const FaultEvent* FaultInjector::find(FaultKind kind) const noexcept {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (active_[i] && events_[i].kind == kind) {
      return &events_[i];
    }
  }
  return nullptr;
}

FaultEvent* FaultInjector::find(FaultKind kind, int channel, int bus) noexcept {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (active_[i] && events_[i].kind == kind && events_[i].concerns(channel) &&
        (bus == FaultEvent::kAll || events_[i].strikes(bus))) {
      return &events_[i];
    }
  }
  return nullptr;
}

bool FaultInjector::waiting() const noexcept {
  return std::any_of(reordered_.begin(), reordered_.end(),
                     [](const auto& frame) { return frame.has_value(); });
}

bool FaultInjector::happens(const FaultEvent& event) noexcept {
  if (event.probability < 1.0 && random_.uniform() >= event.probability) {
    return false;
  }
  note(event);
  return true;
}

void FaultInjector::note(const FaultEvent& event) noexcept {
  const auto index = static_cast<std::size_t>(&event - events_.data());
  if (first_effect_s_[index] < 0.0) {
    first_effect_s_[index] = time_s_;
  }
}

bool FaultInjector::silent(std::uint8_t bus) const noexcept {
  const auto off = struck(FaultKind::kBusOff) | struck(FaultKind::kInterfaceDown);
  return (off & can::busBit(bus)) != 0 || active(FaultKind::kPeerRestart);
}

bool FaultInjector::lost(const can::Frame& frame, FrameChannel channel) noexcept {
  const FaultEvent* event = find(FaultKind::kLostFrames, static_cast<int>(channel), frame.bus);
  return event != nullptr && happens(*event);
}

void FaultInjector::flip(can::Frame& frame, FrameChannel channel) noexcept {
  const FaultEvent* event = find(FaultKind::kFlippedBits, static_cast<int>(channel), frame.bus);
  if (event == nullptr || frame.length == 0 || !happens(*event)) {
    return;
  }
  const int bits = 8 * frame.length;
  std::array<bool, std::size_t{8} * can::kMaxDataLength> flipped{};
  for (int i = 0; i < std::min(event->bits, bits); ++i) {
    std::size_t bit = 0;
    do {
      bit = std::min(static_cast<std::size_t>(random_.uniform() * bits), static_cast<std::size_t>(bits - 1));
    } while (flipped[bit]);
    flipped[bit] = true;
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
  }
}

bool FaultInjector::hold(const can::Frame& frame, FrameChannel channel) noexcept {
  // What a rig that stands still sends at last is under way for as long as any other.
  const FaultEvent* const stall = find(FaultKind::kRigStall);
  const FaultEvent* const delay = find(FaultKind::kDelayedFrames, static_cast<int>(channel), frame.bus);
  const bool delayed = delay != nullptr && happens(*delay);
  if (stall == nullptr && !delayed) {
    return false;
  }
  const double due_s =
      (stall != nullptr ? stall->burstEnd(time_s_) : time_s_) + (delayed ? delay->delay_s : 0.0);
  if (held_count_ < held_.size()) {
    held_[held_count_++] = {frame, channel, due_s};
  }
  return true;
}

void FaultInjector::encoder(int joint, double& position_rad,
                            double& velocity_rad_s) noexcept PATELLA_NONBLOCKING {
  // A fault of a position that is frozen already has no effect yet.
  auto& frozen = frozen_[static_cast<std::size_t>(joint)];
  const FaultEvent* const freeze = find(FaultKind::kEncoderFreeze, joint);
  const bool hidden = freeze != nullptr && frozen;
  if (const FaultEvent* event = find(FaultKind::kEncoderJump, joint); event != nullptr && !hidden) {
    note(*event);
    position_rad += event->value;
  }
  if (const FaultEvent* event = find(FaultKind::kEncoderDrift, joint); event != nullptr && !hidden) {
    note(*event);
    position_rad += event->value * (time_s_ - event->burstStart(time_s_));
  }
  if (const FaultEvent* event = find(FaultKind::kEncoderWrap, joint); event != nullptr && !hidden) {
    note(*event);
    position_rad -= std::copysign(event->value, position_rad);
  }
  if (freeze == nullptr) {
    frozen.reset();
    return;
  }
  note(*freeze);
  if (!frozen) {
    frozen = {position_rad, velocity_rad_s};
  }
  position_rad = frozen->first;
  velocity_rad_s = freeze->with_velocity ? frozen->second : velocity_rad_s;
}

void FaultInjector::emg(EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING {
  for (int channel = 0; channel < kMaxEmgChannels; ++channel) {
    double& signal = signal_mV[static_cast<std::size_t>(channel)];
    if (const FaultEvent* event = find(FaultKind::kEmgHum, channel); event != nullptr) {
      note(*event);
      signal += event->value * std::sin(2.0 * std::numbers::pi * event->frequency_Hz * time_s_);
    }
    if (const FaultEvent* event = find(FaultKind::kEmgDisconnection, channel); event != nullptr) {
      note(*event);
      signal = event->value * random_.gaussian();
    }
    if (const FaultEvent* event = find(FaultKind::kEmgSaturation, channel); event != nullptr) {
      note(*event);
      signal = event->value;
    }
  }
}

DriveDisturbance FaultInjector::drive() noexcept PATELLA_NONBLOCKING {
  DriveDisturbance disturbance;
  for (int joint = 0; joint < kMaxJoints; ++joint) {
    const auto i = static_cast<std::size_t>(joint);
    if (const FaultEvent* event = find(FaultKind::kDriveNotFollowing, joint); event != nullptr) {
      note(*event);
      disturbance.gain[i] = event->value;
    }
    if (const FaultEvent* event = find(FaultKind::kDriveOverTorque, joint); event != nullptr) {
      note(*event);
      disturbance.extra_Nm[i] = event->value;
    }
  }
  return disturbance;
}

bool FaultInjector::acts(FaultKind kind, int channel) noexcept {
  const FaultEvent* event = find(kind, channel);
  if (event != nullptr) {
    note(*event);
  }
  return event != nullptr;
}

FieldDriveDefect FaultInjector::fieldDrive(int joint) noexcept PATELLA_NONBLOCKING {
  const DriveDisturbance disturbance = drive();
  FieldDriveDefect defect;
  defect.gain = disturbance.gain[static_cast<std::size_t>(joint)];
  defect.extra_Nm = disturbance.extra_Nm[static_cast<std::size_t>(joint)];
  defect.silent = acts(FaultKind::kDriveSilent, joint);
  defect.ignores_enter = acts(FaultKind::kDriveIgnoresEnter, joint);
  defect.off = acts(FaultKind::kDriveReboots, joint) || active(FaultKind::kPeerRestart);
  defect.faulty = acts(FaultKind::kDriveReportsFault, joint);
  defect.leaves = acts(FaultKind::kDriveLeaves, joint);
  defect.aborts_sdo = acts(FaultKind::kDriveAbortsSdo, joint);
  defect.wrong_rating = acts(FaultKind::kDriveWrongRating, joint);
  defect.loses_sync = acts(FaultKind::kDriveLosesSync, joint);
  return defect;
}

std::int64_t FaultInjector::wallStep_ns() const noexcept {
  double step_s = 0.0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    step_s += active_[i] && events_[i].kind == FaultKind::kClockStep ? events_[i].value : 0.0;
  }
  return static_cast<std::int64_t>(std::llround(step_s * 1e9));
}

}  // namespace patella::sim
