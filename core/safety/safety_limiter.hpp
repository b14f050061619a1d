// The last step before the wire: whatever the control law asks, this is what a drive may be told.
#pragma once

#include <array>
#include <cstdint>

#include "core/safety/fault.hpp"
#include "core/safety/leaky_score.hpp"
#include "core/types.hpp"

namespace patella::safety {

struct JointLimits {
  double torque_Nm = 0.0;
  double torque_rate_Nm_s = 0.0;
  double velocity_rad_s = 0.0;
  double q_min_rad = 0.0;
  double q_max_rad = 0.0;
  double soft_margin_rad = 0.05;  ///< inside the range, at both ends; at most half of the range
};

struct SafetyLimits {
  std::array<JointLimits, kMaxJoints> joint{};
  double saturation_timeout_s = 0.2;  ///< demand above torque_Nm for longer raises Fault::kTorqueLimit
};

/// Limits that cut a demand. They are ordinary life; faults (fault.hpp) stop the loop.
enum class Limit : std::uint8_t {
  kTorque = 0,  ///< above torque_Nm
  kTorqueRate,  ///< faster than torque_rate_Nm_s
  kSoftRange,   ///< towards the end of the range, within the soft margin
  kVelocity,    ///< in the direction of motion, above kVelocityFade of the velocity limit
};

class LimitSet {
 public:
  constexpr void add(Limit limit) noexcept { bits_ = static_cast<std::uint8_t>(bits_ | mask(limit)); }
  constexpr bool has(Limit limit) const noexcept { return (bits_ & mask(limit)) != 0; }
  constexpr bool any() const noexcept { return bits_ != 0; }
  constexpr std::uint8_t bits() const noexcept { return bits_; }
  constexpr bool operator==(const LimitSet&) const noexcept = default;

 private:
  static constexpr unsigned mask(Limit limit) noexcept { return 1U << static_cast<unsigned>(limit); }
  std::uint8_t bits_ = 0;
};

struct LimiterOutput {
  JointVector torque_Nm;                    ///< zero on any fault
  FaultSet faults;                          ///< kNotFinite, kVelocityLimit, kJointRange, kTorqueLimit
  std::array<LimitSet, kMaxJoints> limits;  ///< per joint; empty on a fault
};

/// Bounds the demand per joint by an interval around zero that shrinks linearly to nothing
///  - towards the end of the range, for torque that drives further out, over the soft margin, and
///  - towards the velocity limit, for torque along the motion (power into the leg);
/// then bounds the change since the last command. Growth of a torque is always rate-limited; shrinking bounds
/// and faults take torque away at once.
class SafetyLimiter {
 public:
  /// Share of the velocity limit above which torque along the motion fades.
  static constexpr double kVelocityFade = 0.8;
  /// Longest step that the rate limit counts, s: the drives drop torque after 20 ms without a command.
  static constexpr double kMaxStep_s = 0.02;

  /// Throws std::invalid_argument naming the key, the value and what was expected.
  SafetyLimiter(int joints, const SafetyLimits& limits);

  /// To be called every tick, with a zero demand while no torque is allowed, so that speed and range are
  /// watched always. A value that is not finite, or a vector without one number per joint, is kNotFinite.
  LimiterOutput apply(const JointVector& demand_Nm, const JointVector& q, const JointVector& dq,
                      double dt_s) noexcept PATELLA_NONBLOCKING;

  /// Torque is off: the next command starts from zero. To be called whenever the state machine forbids
  /// torque.
  void stop() noexcept PATELLA_NONBLOCKING;

 private:
  struct Joint {
    JointLimits limits;
    double last_Nm = 0.0;
    LeakyScore saturated;  ///< s of demand above torque_Nm
  };

  /// Moves one joint's command towards the demand.
  static LimitSet limitJoint(Joint& joint, double demand_Nm, double q, double dq, double dt_s) noexcept;

  bool plausible(const JointVector& values) const noexcept;

  int joints_;
  std::array<Joint, kMaxJoints> joint_{};
};

}  // namespace patella::safety
