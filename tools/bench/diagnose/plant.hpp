// The robot of the benchmark, written without the code that is judged with it: angles of the segments against
// the horizontal instead of joint angles (a chain: Kane's equations), Moreau's midpoint rule at 50 or 100 µs
// instead of Runge and Kutta, and dry friction that sticks, as an impulse in a set, instead of a smoothed
// sign.
//
// Sources: Greenwood, Principles of Dynamics, 2nd ed., 6.6 (absolute angles); Moreau 1999, Computer Methods
// in Applied Mechanics and Engineering 177 (time stepping); Canudas de Wit, Olsson, Åström, Lischinsky 1995,
// IEEE Transactions on Automatic Control 40(3) (LuGre); Riener, Edrich 1999, Journal of Biomechanics 32(5).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "tools/bench/diagnose/chain_body.hpp"
#include "tools/bench/diagnose/kinds.hpp"

namespace patella::bench {

inline constexpr std::size_t kJoints = kMaxJoints;
inline constexpr std::size_t kChannels = 2;  ///< of EMG
inline constexpr double kTick_s = 1e-3;

using Pair = std::array<double, 2>;

enum class Shape { kLeg, kRevolute, kPrismatic, kChain };

/// Rigid body with linear damping, as it is. For a prismatic joint read m, N, N·s/m.
struct Body {
  Shape shape = Shape::kLeg;
  Pair mass_kg{};                           ///< leg; prismatic: [0]
  Pair length_m{};                          ///< leg
  Pair com_m{};                             ///< leg
  Pair inertia_kg_m2{};                     ///< leg: about the centres of mass; revolute: [0], about the axis
  double moment_kg_m = 0.0;                 ///< revolute
  double inclination_rad = 0.0;             ///< prismatic
  double gravity_m_s2 = 9.81;               ///< of a chain: in the chain
  model::SerialChainParameters chain = {};  ///< ends with a fixed link, whose origin is the end point
  PerJoint damping_Nms_rad{};

  std::size_t joints() const noexcept {
    return shape == Shape::kChain ? static_cast<std::size_t>(chain.joints()) : shape == Shape::kLeg ? 2 : 1;
  }
  bool slides(std::size_t joint) const {
    return shape == Shape::kPrismatic ||
           (shape == Shape::kChain &&
            chain.links[linkOfJoint(chain, joint)].joint == model::ChainJoint::kPrismatic);
  }
};

/// Torque on the robot from outside, a value a tick of 1 ms, linear in between.
struct Surroundings {
  std::array<std::vector<double>, kJoints> human_Nm;
  std::array<std::vector<double>, kChannels> activation;  ///< 0…1
  std::vector<double> phase_walk;  ///< random walk of variance 1 a second, for what wanders
};

class Plant {
 public:
  /// At rest unless a velocity is given. `surroundings` must outlive it and reach as far as it is advanced;
  /// an empty signal is zero.
  Plant(const Body& body, std::span<const TrueEffect> effects, const Surroundings& surroundings,
        const PerJoint& position, const PerJoint& velocity = {});

  /// One tick with the command held.
  void advance(const PerJoint& command_Nm);

  /// Joint angles as they are.
  PerJoint position() const noexcept;
  PerJoint velocity() const noexcept;
  /// Angles that the encoders count; they may be mounted askew.
  PerJoint encoder() const noexcept;
  /// Angle of the motor, which differs from the joint's where the transmission gives way.
  PerJoint motorPosition() const noexcept;
  /// Kinetic and potential energy of the segments, J.
  double energy() const;

 private:
  struct Memory {
    double bristle = 0.0;          // LuGre
    double stretch = 0.0;          // of tissue that relaxes
    std::vector<double> velocity;  // spasticity: one a step
  };
  struct Motor {
    bool apart = false;
    double angle = 0.0, rate = 0.0;
    double inertia = 0.0, stiffness = 0.0, damping = 0.0, half_gap = 0.0;
    bool pulls = true;
  };
  struct Drive {
    double gain = 1.0, lag_s = 0.0, delay_s = 0.0, lagged = 0.0;
    std::vector<double> commands;
  };
  // The effects' input at an instant.
  struct Instant {
    double time_s = 0.0;
    PerJoint q{}, dq{}, drive_Nm{};
  };
  // Smooth torque on a joint, how much dry friction can hold there against motion forwards and backwards, and
  // inertia that is there in addition.
  struct Load {
    PerJoint torque{};
    PerJoint against_forward{}, against_backward{};
    PerJoint inertia{};
  };

  void setBody(const Body& body);
  void mount(const TrueEffect& effect, Body& body);
  void step(std::size_t step_in_tick);
  PerJoint toJoints(const PerJoint& segments) const noexcept;
  double signalAt(const std::vector<double>& signal, double time_s) const noexcept;
  static Pair dryFriction(const TrueEffect& effect, const Instant& now);  // forwards and backwards
  double driveTorque(std::size_t joint, double time_s);
  double softTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const;
  double defectTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const;
  double humanTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const;
  PerJoint solveVelocity(const PerJoint& middle, const PerJoint& rate, const Load& load) const;

  PerJoint solveChain(const PerJoint& middle, const PerJoint& rate, const Load& load) const;

  Shape shape_;
  std::size_t steps_;  // of a tick
  double step_s_;
  std::size_t joints_;
  // Kinetic energy ½ a v1² + ½ d v2² + c cos(θ1 − θ2) v1 v2 and potential g (w1 sin θ1 + w2 sin θ2).
  double a_ = 0.0, d_ = 0.0, c_ = 0.0, w1_ = 0.0, w2_ = 0.0;
  PerJoint rotor_{};
  std::unique_ptr<ChainBody> chain_;  // θ and v are then those of the joints
  double gravity_ = 0.0;
  PerJoint damping_{};
  PerJoint encoder_offset_{};
  std::vector<TrueEffect> effects_;
  std::vector<Memory> memory_;
  std::array<Motor, kJoints> motor_;
  std::array<Drive, kJoints> drive_;
  const Surroundings* surroundings_;

  PerJoint theta_{}, v_{}, v_before_{};
  std::size_t tick_ = 0;
};

}  // namespace patella::bench
