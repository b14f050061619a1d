#include "sim/cia402_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sim/cia402_objects.hpp"

namespace patella::sim {
namespace {

constexpr std::uint8_t kBootUp = 0x00;
constexpr std::uint8_t kStopped = 0x04;
constexpr std::uint8_t kOperational = 0x05;
constexpr std::uint8_t kPreOperational = 0x7F;

constexpr std::uint32_t kPdoOff = 0x80000000;
constexpr std::uint32_t kIdentifier = 0x7FF;
constexpr std::uint32_t kTorqueMode = 10;

constexpr std::uint32_t kHeartbeatError = 0x8130;
constexpr std::uint32_t kSyncError = 0x8700;
constexpr std::uint32_t kOverTemperature = 0x4310;

constexpr std::int64_t kMillisecond_ns = 1'000'000;

FieldDriveOptions withoutWatchdog(FieldDriveOptions options) {
  options.watchdog_s = 0.0;  // commands alone do not keep it going: heartbeats and SYNC do
  return options;
}

std::uint32_t readNumber(const can::Frame& frame, std::size_t at, std::size_t bytes) noexcept {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    number |= static_cast<std::uint32_t>(frame.data[at + i]) << (8U * i);
  }
  return number;
}

void writeNumber(can::Frame& frame, std::size_t at, std::size_t bytes, std::uint32_t number) noexcept {
  for (std::size_t i = 0; i < bytes; ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(number >> (8U * i));
  }
}

}  // namespace

Cia402Drive::Cia402Drive(const FieldDriveOptions& options)
    : FieldDrive(withoutWatchdog(options)),
      dictionary_(cia402Objects(options)),
      server_(options.id, "Patella rig drive"),
      sync_timeout_ns_(std::llround(1e9 * options.watchdog_s)),
      network_state_(kBootUp) {}

double Cia402Drive::newtonMetresPerMille() const noexcept {
  constexpr double kPerMille = 1e-3;
  return kPerMille * options().rated_torque_Nm * options().gear * options().direction;
}

can::Frame Cia402Drive::blank(std::uint32_t base, int length) const noexcept {
  can::Frame frame;
  frame.id = base + static_cast<std::uint32_t>(options().id);
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

void Cia402Drive::put(FrameSink& sink, const can::Frame& frame) const noexcept {
  if (!defect().silent) {
    sink.put(frame);
  }
}

bool Cia402Drive::hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
                       FrameSink& replies) noexcept {
  const auto node = static_cast<std::uint32_t>(options().id);
  const std::uint32_t consumed = dictionary_.value(0x1016, 1);
  settle();
  bool taken = true;
  if (frame.id == 0 && frame.length == 2) {
    manage(frame);
  } else if (frame.id == 0x600 + node && frame.length == 8) {
    serve(frame, replies);
  } else if ((consumed & 0xFFFFU) != 0 && frame.id == 0x700 + (consumed >> 16U & 0x7FU)) {
    starveAt(now_ns + static_cast<std::int64_t>(consumed & 0xFFFFU) * kMillisecond_ns);
  } else if (network_state_ == kOperational && frame.id == dictionary_.value(0x1400, 1)) {
    receive(frame, now_ns);
  } else if (network_state_ == kOperational && frame.id == dictionary_.value(0x1005) &&
             !defect().loses_sync) {
    sync_ns_ = now_ns;
    transmit(joint, replies);
  } else {
    taken = false;
  }
  was_enabled_ = enabled();
  return taken;
}

void Cia402Drive::manage(const can::Frame& frame) noexcept {
  if (frame.data[1] != 0 && frame.data[1] != options().id) {
    return;
  }
  switch (frame.data[0]) {
    case 0x01:
      network_state_ = kOperational;
      break;
    case 0x02:
      network_state_ = kStopped;
      break;
    case 0x80:
      network_state_ = kPreOperational;
      break;
    case 0x81:
    case 0x82:
      leave();
      forget();
      break;
    default:
      break;
  }
}

void Cia402Drive::serve(const can::Frame& frame, FrameSink& replies) noexcept {
  const auto may = [this](const DictionaryObject& object, std::uint32_t value) noexcept {
    return defect().aborts_sdo ? AbortCode::kDeviceState : allow(object, value);
  };
  const auto done = [this](const DictionaryObject& object) noexcept { written(object); };
  if (network_state_ != kStopped) {
    dictionary_.set(0x6041, 0, statusWord());
    put(replies, server_.answer(frame, dictionary_, may, done));
  }
}

AbortCode Cia402Drive::allow(const DictionaryObject& object, std::uint32_t value) const noexcept {
  constexpr std::array<std::pair<unsigned, unsigned>, 4> kPdos = {
      {{0x1400, 0x1600}, {0x1401, 0x1601}, {0x1800, 0x1A00}, {0x1801, 0x1A01}}};
  for (const auto& [communication, mapping] : kPdos) {
    if (object.index == mapping) {
      return allowMapping(communication, object, value);
    }
    const bool on = (dictionary_.value(communication, 1) & kPdoOff) == 0;
    if (object.index == communication && on && (object.sub != 1 || (value & kPdoOff) == 0)) {
      return AbortCode::kDeviceState;
    }
  }
  return AbortCode::kNone;
}

AbortCode Cia402Drive::allowMapping(unsigned communication, const DictionaryObject& object,
                                    std::uint32_t value) const noexcept {
  constexpr std::uint32_t kMostBits = 64;
  const bool off = (dictionary_.value(communication, 1) & kPdoOff) != 0;
  if (!off || (object.sub != 0 && dictionary_.value(object.index) != 0)) {
    return AbortCode::kDeviceState;
  }
  if (object.sub != 0) {
    const DictionaryObject* mapped = dictionary_.find(value >> 16U, value >> 8U & 0xFFU);
    const bool fits = mapped != nullptr && mapped->mappable && 8U * mapped->bytes == (value & 0xFFU);
    return fits ? AbortCode::kNone : AbortCode::kNotMappable;
  }
  std::uint32_t bits = 0;
  for (std::uint32_t entry = 1; entry <= value; ++entry) {
    if (dictionary_.find(object.index, entry) == nullptr) {
      return AbortCode::kPdoTooLong;
    }
    bits += dictionary_.value(object.index, entry) & 0xFFU;
  }
  return bits <= kMostBits ? AbortCode::kNone : AbortCode::kPdoTooLong;
}

void Cia402Drive::written(const DictionaryObject& object) noexcept {
  if (object.index == 0x6060) {
    dictionary_.set(0x6061, 0, object.value);
  } else if (object.index == 0x6040) {
    obey(object.value, 0);
  } else if (object.index == 0x1016 && (object.value & 0xFFFFU) == 0) {
    starveAt(std::numeric_limits<std::int64_t>::max());
  }
}

void Cia402Drive::receive(const can::Frame& frame, std::int64_t now_ns) noexcept {
  std::size_t at = 0;
  const std::uint32_t entries = dictionary_.value(0x1600);
  for (std::uint32_t entry = 1; entry <= entries; ++entry) {
    const std::uint32_t mapping = dictionary_.value(0x1600, entry);
    const std::size_t bytes = (mapping & 0xFFU) / 8U;
    if (at + bytes > frame.length) {
      return;  // too short: nothing of it counts
    }
    dictionary_.set(mapping >> 16U, mapping >> 8U & 0xFFU, readNumber(frame, at, bytes));
    at += bytes;
  }
  obey(dictionary_.value(0x6040), now_ns);
  const bool torque_mode = dictionary_.value(0x6060) == kTorqueMode;
  const auto target = static_cast<std::int16_t>(dictionary_.value(0x6071));
  command(torque_mode ? target * newtonMetresPerMille() : 0.0, now_ns);
}

void Cia402Drive::transmit(const JointReading& joint, FrameSink& replies) noexcept {
  const FieldDriveOptions& o = options();
  constexpr double kMostTorque = 32767.0;
  const double counts = (joint.position_rad - o.zero_angle_rad) / (2.0 * std::numbers::pi) * o.gear *
                        o.counts_per_turn * o.direction;
  const double per_mille = std::clamp(torque() / newtonMetresPerMille(), -kMostTorque, kMostTorque);
  dictionary_.set(0x6064, 0, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(counts))));
  dictionary_.set(0x6077, 0, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(per_mille))));
  dictionary_.set(0x6041, 0, statusWord());
  const std::uint32_t id = dictionary_.value(0x1800, 1);
  if ((id & kPdoOff) != 0 || dictionary_.value(0x1800, 2) != 1) {
    return;
  }
  can::Frame frame;
  frame.id = id & kIdentifier;
  const std::uint32_t entries = dictionary_.value(0x1A00);
  for (std::uint32_t entry = 1; entry <= entries; ++entry) {
    const std::uint32_t mapping = dictionary_.value(0x1A00, entry);
    const std::size_t bytes = (mapping & 0xFFU) / 8U;
    writeNumber(frame, frame.length, bytes, dictionary_.value(mapping >> 16U, mapping >> 8U & 0xFFU));
    frame.length = static_cast<std::uint8_t>(frame.length + bytes);
  }
  put(replies, frame);
}

// Commands as the standard's table has them: which bits have to be set, which not.
void Cia402Drive::obey(std::uint32_t controlword, std::int64_t now_ns) noexcept {
  const bool reset_edge = (controlword & ~controlword_ & 0x80U) != 0;
  controlword_ = controlword;
  if (state_ == State::kFault) {
    if (reset_edge && !defect().faulty) {
      state_ = State::kSwitchOnDisabled;
      dictionary_.set(0x603F, 0, 0);
      dictionary_.set(0x1001, 0, 0);
      emergency_ = true;  // tells that the error has gone
    }
    return;
  }
  const bool disable_voltage = (controlword & 0x02U) == 0;
  const bool quick_stop = (controlword & 0x06U) == 0x02U;
  const bool shutdown = (controlword & 0x87U) == 0x06U;
  const bool switch_on = (controlword & 0x8FU) == 0x07U;
  const bool enable = (controlword & 0x8FU) == 0x0FU;
  if (disable_voltage || (quick_stop && !enabled())) {
    state_ = State::kSwitchOnDisabled;
    leave();
  } else if (quick_stop) {
    state_ = State::kQuickStop;
    leave();
  } else if (shutdown && state_ != State::kQuickStop) {
    state_ = State::kReady;
    leave();
  } else if (switch_on && state_ == State::kReady) {
    state_ = State::kSwitchedOn;
  } else if (switch_on && state_ == State::kSwitchedOn) {
    leave();
  } else if (enable && state_ == State::kSwitchedOn) {
    enter(now_ns);
  }
}

void Cia402Drive::fall(std::uint32_t code) noexcept {
  constexpr std::uint32_t kGeneric = 0x01;
  constexpr std::uint32_t kCommunication = 0x10;
  if (state_ == State::kFault) {
    return;
  }
  state_ = State::kFault;
  leave();
  emergency_ = true;
  dictionary_.set(0x603F, 0, code);
  dictionary_.set(0x1001, 0, kGeneric | (code >> 12U == 8U ? kCommunication : 0U));
}

// A defect may have taken it out of enabled: its voltage is off then.
void Cia402Drive::settle() noexcept {
  if (was_enabled_ && !enabled() && state_ == State::kSwitchedOn) {
    state_ = State::kSwitchOnDisabled;
  }
}

void Cia402Drive::report(const JointReading& /*joint*/, std::int64_t now_ns, FrameSink& frames) noexcept {
  constexpr std::uint32_t kWrongUnit = 1000;
  settle();
  if (starting_) {
    starting_ = false;
    network_state_ = kPreOperational;
    dictionary_.set(0x6076, 0, dictionary_.value(0x6076) * (defect().wrong_rating ? kWrongUnit : 1U));
    put(frames, blank(0x700, 1));
  }
  if (defect().faulty) {
    fall(kOverTemperature);
  } else if (enabled() && sync_timeout_ns_ > 0 && now_ns - sync_ns_ > sync_timeout_ns_) {
    fall(kSyncError);
  }
  if (emergency_) {
    emergency_ = false;
    can::Frame emergency = blank(0x080, 8);
    writeNumber(emergency, 0, 2, dictionary_.value(0x603F));
    emergency.data[2] = static_cast<std::uint8_t>(dictionary_.value(0x1001));
    put(frames, emergency);
  }
  const auto heartbeat_ns = static_cast<std::int64_t>(dictionary_.value(0x1017)) * kMillisecond_ns;
  if (heartbeat_ns > 0 && now_ns >= next_heartbeat_ns_) {
    next_heartbeat_ns_ = now_ns + heartbeat_ns;
    can::Frame heartbeat = blank(0x700, 1);
    heartbeat.data[0] = network_state_;
    put(frames, heartbeat);
  }
  was_enabled_ = enabled();
}

void Cia402Drive::starved() noexcept {
  fall(kHeartbeatError);
}

void Cia402Drive::forget() noexcept {
  dictionary_.reset();
  state_ = State::kSwitchOnDisabled;
  network_state_ = kBootUp;
  starting_ = true;
  emergency_ = was_enabled_ = false;
  controlword_ = 0;
  next_heartbeat_ns_ = 0;
}

// Voltage and remote are set besides in every state.
std::uint32_t Cia402Drive::statusWord() const noexcept {
  constexpr std::uint32_t kBesides = 0x0210;
  switch (state_) {
    case State::kSwitchOnDisabled:
      return kBesides | 0x40U;
    case State::kReady:
      return kBesides | 0x21U;
    case State::kSwitchedOn:
      return kBesides | (enabled() ? 0x1027U : 0x23U);
    case State::kQuickStop:
      return kBesides | 0x07U;
    case State::kFault:
      break;
  }
  return kBesides | 0x08U;
}

}  // namespace patella::sim
