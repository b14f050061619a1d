#include "sim/odrive.hpp"

#include <bit>
#include <cmath>
#include <numbers>

namespace patella::sim {
namespace {

constexpr unsigned kHeartbeat = 0x01;
constexpr unsigned kSetAxisState = 0x07;
constexpr unsigned kEncoderEstimates = 0x09;
constexpr unsigned kInputTorque = 0x0E;
constexpr unsigned kTemperature = 0x15;
constexpr unsigned kClearErrors = 0x18;
constexpr unsigned kTorques = 0x1C;

constexpr std::uint32_t kIdle = 1;
constexpr std::uint32_t kClosedLoop = 8;
constexpr std::uint32_t kWatchdogExpired = 0x01000000;
constexpr std::uint32_t kOverTemperature = 0x00020000;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr float kInverter_degC = 31.5F;
constexpr float kMotor_degC = 36.25F;

std::uint32_t readWord(const can::Frame& frame) noexcept {
  std::uint32_t word = 0;
  for (unsigned i = 0; i < 4; ++i) {
    word |= std::uint32_t{frame.data[i]} << (8U * i);
  }
  return word;
}

void writeWord(can::Frame& frame, std::size_t at, std::uint32_t word) noexcept {
  for (std::size_t i = 0; i < 4; ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(word >> (8U * i));
  }
}

void writeFloats(can::Frame& frame, float first, float second) noexcept {
  writeWord(frame, 0, std::bit_cast<std::uint32_t>(first));
  writeWord(frame, 4, std::bit_cast<std::uint32_t>(second));
}

}  // namespace

can::Frame Odrive::blank(unsigned command, int length) const noexcept {
  can::Frame frame;
  frame.id = static_cast<std::uint32_t>(options().id) << 5U | command;
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

bool Odrive::hear(const can::Frame& frame, const JointReading& /*joint*/, std::int64_t now_ns,
                  FrameSink& /*replies*/) noexcept {
  constexpr unsigned kCommandMask = 0x1F;
  if (frame.id >> 5U != static_cast<std::uint32_t>(options().id)) {
    return false;
  }
  switch (frame.id & kCommandMask) {
    case kSetAxisState:
      if (frame.length >= 4 && readWord(frame) == kClosedLoop && error_ == 0) {
        enter(now_ns);
      } else if (frame.length >= 4 && readWord(frame) == kIdle) {
        leave();
      }
      return true;
    case kInputTorque:
      if (frame.length >= 4) {
        const auto torque_Nm = std::bit_cast<float>(readWord(frame));
        target_Nm_ = std::isfinite(torque_Nm) ? torque_Nm : 0.0F;
        command(target_Nm_, now_ns);
      }
      return true;
    case kClearErrors:
      error_ = 0;
      return true;
    default:
      return false;
  }
}

void Odrive::report(const JointReading& joint, std::int64_t now_ns, FrameSink& frames) noexcept {
  if (defect().faulty && error_ == 0) {
    error_ = kOverTemperature;
    leave();
  }
  can::Frame estimates = blank(kEncoderEstimates, 8);
  writeFloats(estimates, static_cast<float>(joint.position_rad / kTurn_rad),
              static_cast<float>(joint.velocity_rad_s / kTurn_rad));
  frames.put(estimates);
  can::Frame torques = blank(kTorques, 8);
  writeFloats(torques, enabled() ? target_Nm_ : 0.0F, static_cast<float>(torque()));
  frames.put(torques);
  if (now_ns >= next_heartbeat_ns_) {
    next_heartbeat_ns_ = now_ns + std::llround(options().heartbeat_period_s * 1e9);
    can::Frame heartbeat = blank(kHeartbeat, 8);
    writeWord(heartbeat, 0, error_);
    heartbeat.data[4] = static_cast<std::uint8_t>(enabled() ? kClosedLoop : kIdle);
    frames.put(heartbeat);
    can::Frame temperature = blank(kTemperature, 8);
    writeFloats(temperature, kInverter_degC, kMotor_degC);
    frames.put(temperature);
  }
}

void Odrive::starved() noexcept {
  error_ = kWatchdogExpired;
  leave();
}

void Odrive::forget() noexcept {
  error_ = 0;
  target_Nm_ = 0.0F;
}

}  // namespace patella::sim
