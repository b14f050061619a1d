#include "sim/mit_motor.hpp"

#include <algorithm>
#include <cmath>

namespace patella::sim {
namespace {

constexpr double kStiffnessRange_Nm_rad = 500.0;
constexpr double kDampingRange_Nms_rad = 5.0;
constexpr unsigned kTemperature_degC = 25;
constexpr unsigned kOverTemperature = 1;

double toNumber(unsigned raw, double low, double high, int bits) noexcept {
  return low + (high - low) * raw / static_cast<double>((1U << static_cast<unsigned>(bits)) - 1U);
}

unsigned toRaw(double value, double low, double high, int bits) noexcept {
  const double steps = static_cast<double>((1U << static_cast<unsigned>(bits)) - 1U);
  return static_cast<unsigned>(std::lround((std::clamp(value, low, high) - low) / (high - low) * steps));
}

}  // namespace

bool MitMotor::hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
                    FrameSink& replies) noexcept {
  constexpr std::uint8_t kSize = 8;
  if (frame.id != static_cast<std::uint32_t>(options().id) || frame.length != kSize) {
    return false;
  }
  const auto& d = frame.data;
  const bool special = std::all_of(d.begin(), d.begin() + 7, [](std::uint8_t byte) { return byte == 0xFF; });
  if (special && d[7] == 0xFC) {
    enter(now_ns);
  } else if (special && d[7] == 0xFD) {
    leave();
  } else if (!special || d[7] != 0xFE) {
    const auto& o = options();
    const double p = toNumber(d[0] << 8U | d[1], -o.position_range_rad, o.position_range_rad, 16);
    const double v = toNumber(d[2] << 4U | d[3] >> 4U, -o.velocity_range_rad_s, o.velocity_range_rad_s, 12);
    const double kp = toNumber((d[3] & 0xFU) << 8U | d[4], 0.0, kStiffnessRange_Nm_rad, 12);
    const double kd = toNumber(d[5] << 4U | d[6] >> 4U, 0.0, kDampingRange_Nms_rad, 12);
    const double t = toNumber((d[6] & 0xFU) << 8U | d[7], -o.torque_range_Nm, o.torque_range_Nm, 12);
    command(kp * (p - joint.position_rad) + kd * (v - joint.velocity_rad_s) + t, now_ns);
  }
  if (!defect().silent) {
    reply(joint, replies);
  }
  return true;
}

void MitMotor::reply(const JointReading& joint, FrameSink& replies) const noexcept {
  const auto& o = options();
  const unsigned p = toRaw(joint.position_rad, -o.position_range_rad, o.position_range_rad, 16);
  const unsigned v = toRaw(joint.velocity_rad_s, -o.velocity_range_rad_s, o.velocity_range_rad_s, 12);
  const unsigned t = toRaw(torque(), -o.torque_range_Nm, o.torque_range_Nm, 12);
  can::Frame frame;
  frame.id = static_cast<std::uint32_t>(o.master_id);
  frame.length = 8;
  const std::array<unsigned, 8> bytes = {
      static_cast<unsigned>(o.id), p >> 8U,   p & 0xFFU,         v >> 4U,
      (v & 0xFU) << 4U | t >> 8U,  t & 0xFFU, kTemperature_degC, defect().faulty ? kOverTemperature : 0U};
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](unsigned byte) { return static_cast<std::uint8_t>(byte); });
  replies.put(frame);
}

}  // namespace patella::sim
