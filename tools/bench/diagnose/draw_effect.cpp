#include "tools/bench/diagnose/draw_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/bench/diagnose/constants.hpp"

namespace patella::bench {
namespace {

// How big things are at a joint, so that effects can be drawn in proportion.
struct Scale {
  double human_Nm = 0.0;
  double speed_rad_s = 0.0;  // rms
  double range_rad = 0.0;    // peak from the middle
  double torque_Nm = 0.0;    // rms
  double inertia_kg_m2 = 0.0;
  double centre_rad = 0.0;
};

Scale scaleOf(const Rig& rig, std::size_t joint) {
  Scale scale{.human_Nm = rig.human_Nm[joint], .centre_rad = rig.reference[joint].centre_rad};
  double speed = 0.0, torque = 0.0;
  int count = 0;
  InverseDynamics dynamics(rig.body);
  for (double time_s = 2.0; time_s < rig.duration_s; time_s += 0.02) {
    const Target target = targetAt(rig.reference, time_s);
    const PerJoint tau = dynamics(target.q, target.dq, target.ddq);
    speed += target.dq[joint] * target.dq[joint];
    torque += tau[joint] * tau[joint];
    scale.range_rad = std::max(scale.range_rad, std::abs(target.q[joint] - scale.centre_rad));
    ++count;
  }
  scale.speed_rad_s = std::sqrt(speed / count);
  scale.torque_Nm = std::sqrt(torque / count);
  PerJoint unit{}, middle{};
  unit[joint] = 1.0;
  for (std::size_t j = 0; j < rig.body.joints(); ++j) {
    middle[j] = rig.reference[j].centre_rad;
  }
  scale.inertia_kg_m2 = InverseDynamics(weightless(rig.body))(middle, {}, unit)[joint];
  return scale;
}

using Parameters = std::array<double, kMaxParameters>;

// A motor apart from its link, with the inertia, resonance (link held) and damping ratio.
Parameters motorBehindSpring(double inertia, double resonance_rad_s, double damping_ratio) {
  return {inertia * resonance_rad_s * resonance_rad_s, inertia,
          2.0 * damping_ratio * inertia * resonance_rad_s};
}

Parameters drawFriction(Random& random, Kind kind, const Scale& s) {
  const double level = 2.0 * s.human_Nm;
  switch (kind) {
    case Kind::kViscous:
      return {level / s.speed_rad_s};
    case Kind::kCoulomb:
      return {level};
    case Kind::kAsymmetric: {
      const double weak = random.uniform(0.2, 0.6);
      Parameters p{level, weak * level};
      if (random.chance(0.5)) {
        p[2] = random.uniform(0.2, 1.0) * level / s.speed_rad_s;
        p[3] = random.uniform(0.2, 1.0) * level / s.speed_rad_s;
      }
      if (random.chance(0.5)) {
        std::swap(p[0], p[1]);
      }
      return p;
    }
    case Kind::kStribeck:
      return {level, random.uniform(0.5, 1.5) * level, random.uniform(0.05, 0.3) * s.speed_rad_s};
    case Kind::kLoadDependent:
      return {level / s.torque_Nm};
    case Kind::kPresliding: {
      const double bend_rad = random.uniform(0.01, 0.08) * s.range_rad;
      return {level, level / bend_rad, 0.05 * level / s.speed_rad_s};
    }
    case Kind::kCubicDrag:
      return {level / std::pow(s.speed_rad_s, 3)};
    default:  // kRubbingSpot
      return {2.0 * level, s.centre_rad + random.uniform(-0.4, 0.4) * s.range_rad,
              random.uniform(0.15, 0.3) * s.range_rad};
  }
}

Parameters drawSpring(Random& random, Kind kind, const Scale& s) {
  const double slope = 2.0 * s.human_Nm / s.range_rad;
  const double rest = s.centre_rad + random.uniform(-0.5, 0.5) * s.range_rad;
  switch (kind) {
    case Kind::kContact: {
      const double side = random.sign();
      return {20.0 * slope, s.centre_rad + side * random.uniform(0.2, 0.6) * s.range_rad, side};
    }
    case Kind::kVaryingStiffness:
      return {2.0 * slope, rest, random.uniform(0.05, 0.3)};
    case Kind::kHardeningSpring:
      return {slope / (s.range_rad * s.range_rad), rest};
    default:  // kStiffness
      return {2.0 * slope, rest};
  }
}

Parameters drawMachine(Random& random, Kind kind, const Scale& s, const Rig& rig, std::size_t joint) {
  switch (kind) {
    case Kind::kPayload: {
      const double share = random.uniform(0.2, 0.6);
      if (rig.body.shape == Shape::kLeg) {
        return {share * rig.body.mass_kg[joint], random.uniform(0.4, 1.0) * rig.body.length_m[joint]};
      }
      if (rig.body.shape == Shape::kChain) {
        const std::size_t link = linkOfJoint(rig.body.chain, joint);
        return {share * rig.body.chain.links[link].mass_kg,
                random.uniform(0.4, 1.0) * rig.body.chain.links[link + 1].origin_m.norm()};
      }
      constexpr double kShank_kg = 4.0;
      return {share * kShank_kg, random.uniform(0.15, 0.4)};
    }
    case Kind::kRotor:
      return {random.uniform(0.1, 0.4) * s.inertia_kg_m2};
    case Kind::kElasticity: {
      // One after the other: a call may evaluate its arguments in any order.
      const double resonance_Hz = random.uniform(3.0, 10.0);
      const double damping_ratio = random.uniform(0.05, 0.2);
      return motorBehindSpring(0.2 * s.inertia_kg_m2, kTurn * resonance_Hz, damping_ratio);
    }
    case Kind::kBacklash: {
      constexpr double kContact_rad_s = 600.0, kContactDamping = 0.3;
      const Parameters motor =
          motorBehindSpring(random.uniform(0.03, 0.05) * s.inertia_kg_m2, kContact_rad_s, kContactDamping);
      return {0.02, motor[0], motor[2], motor[1]};
    }
    case Kind::kRipple:
      return {2.0 * s.human_Nm, std::max(1.5 / (2.0 * s.range_rad), random.uniform(0.7, 4.0) / s.speed_rad_s),
              random.uniform(-kPi, kPi)};
    case Kind::kGain:
      return {random.sign() * random.uniform(0.05, 0.15)};
    case Kind::kBias:
      return {random.sign() * 2.0 * s.human_Nm};
    case Kind::kOffset:
      return {random.sign() * 0.02};
    case Kind::kVaryingInertia:
      return {random.sign() * 0.2 * s.inertia_kg_m2};
    default:  // kLag, kDelay
      return {0.004};
  }
}

Parameters drawDefect(Random& random, Kind kind, const Scale& s, const Rig& rig) {
  const double level = 2.0 * s.human_Nm;
  switch (kind) {
    case Kind::kLoadTakenUp:
      return {random.sign() * 2.0 * level, random.uniform(0.3, 0.6) * rig.duration_s};
    case Kind::kRelaxingTissue:
      return {2.0 * level / s.range_rad, random.uniform(0.3, 3.0)};
    case Kind::kDraggingBrake:
      return {2.0 * level, random.uniform(2.0, 8.0)};
    case Kind::kEccentricBearing:
      return {2.0 * level / s.speed_rad_s, random.uniform(0.5, 1.5) / s.range_rad, random.uniform(-kPi, kPi)};
    case Kind::kSnaggingCable: {
      const double side = random.sign();
      return {4.0 * level / s.range_rad, s.centre_rad + side * random.uniform(-0.2, 0.4) * s.range_rad, side};
    }
    case Kind::kWeakeningDrive:
      return {0.2, 2.0 * s.speed_rad_s};
    case Kind::kDeadZone:
      return {level};
    default:  // kDeratingDrive
      return {0.2, random.uniform(0.3, 1.0) * rig.duration_s};
  }
}

Parameters drawPatient(Random& random, Kind kind, const Scale& s, const Rig& rig, std::size_t joint) {
  const double level = 2.0 * s.human_Nm;
  const double channel =
      rig.emg_channels > 0 ? 1.0 + static_cast<double>(random.below(rig.emg_channels)) : 1.0;
  switch (kind) {
    case Kind::kPassiveKnee:
      return {0.1};
    case Kind::kTremor:
      return {level, random.uniform(3.0, 9.0), random.uniform(-kPi, kPi),
              random.chance(0.5) ? random.uniform(2.0, 10.0) : 0.0};
    case Kind::kSpasticity:
      return {2.0 * level / s.speed_rad_s, random.uniform(0.3, 1.0) * s.speed_rad_s,
              random.uniform(0.02, 0.06), random.sign()};
    case Kind::kEmg:
      return {random.sign() * 2.0 * level, channel, random.uniform(0.02, 0.1)};
    case Kind::kBiarticular: {
      const Scale other = scaleOf(rig, 1 - joint);
      return {level / other.range_rad, other.centre_rad + random.uniform(-0.3, 0.3) * other.range_rad};
    }
    case Kind::kEmgStiffness:
      return {4.0 * level / s.range_rad, s.centre_rad + random.uniform(-1.0, 1.0) * s.range_rad, channel};
    default: {  // kThermal: one part of it
      const double constant_s = std::max(10.0, random.uniform(0.3, 1.2) * rig.duration_s);
      const std::size_t part = random.below(3);
      Parameters p{0.0, 0.0, 0.0, constant_s};
      p[part] = part == 0 ? random.sign() * 2.0 * level : 2.0 * level / (part == 2 ? s.speed_rad_s : 1.0);
      return p;
    }
  }
}

}  // namespace

bool applicable(Kind kind, std::size_t joint, const Rig& rig) {
  const Shape shape = rig.body.shape;
  const bool human = rig.emg_channels > 0;
  switch (kind) {
    case Kind::kPassiveKnee:
      return human && (shape == Shape::kRevolute || (shape == Shape::kLeg && joint == 1));
    case Kind::kEmg:
    case Kind::kEmgStiffness:
    case Kind::kSpasticity:
      return human;
    case Kind::kPayload:
    case Kind::kOffset:
    case Kind::kVaryingInertia:  // along an axis, an angle means nothing
      return !rig.body.slides(joint);
    case Kind::kBiarticular:
      return human && shape == Shape::kLeg;
    default:
      return true;
  }
}

TrueEffect drawEffect(Random& random, Kind kind, std::size_t joint, const Rig& rig) {
  const Scale scale = scaleOf(rig, joint);
  TrueEffect effect{.kind = kind, .joint = joint};
  switch (kind) {
    case Kind::kViscous:
    case Kind::kCoulomb:
    case Kind::kAsymmetric:
    case Kind::kStribeck:
    case Kind::kLoadDependent:
    case Kind::kPresliding:
    case Kind::kCubicDrag:
    case Kind::kRubbingSpot:
      effect.p = drawFriction(random, kind, scale);
      break;
    case Kind::kStiffness:
    case Kind::kContact:
    case Kind::kVaryingStiffness:
    case Kind::kHardeningSpring:
      effect.p = drawSpring(random, kind, scale);
      break;
    case Kind::kPassiveKnee:
    case Kind::kTremor:
    case Kind::kSpasticity:
    case Kind::kEmg:
    case Kind::kThermal:
    case Kind::kBiarticular:
    case Kind::kEmgStiffness:
      effect.p = drawPatient(random, kind, scale, rig, joint);
      break;
    case Kind::kLoadTakenUp:
    case Kind::kRelaxingTissue:
    case Kind::kDraggingBrake:
    case Kind::kEccentricBearing:
    case Kind::kSnaggingCable:
    case Kind::kWeakeningDrive:
    case Kind::kDeadZone:
    case Kind::kDeratingDrive:
      effect.p = drawDefect(random, kind, scale, rig);
      break;
    default:
      effect.p = drawMachine(random, kind, scale, rig, joint);
  }
  return effect;
}

Pair sizeLimits(const Rig& rig, const TrueEffect& effect) {
  const double inertia = scaleOf(rig, effect.joint).inertia_kg_m2;
  switch (effect.kind) {
    case Kind::kLoadDependent:
    case Kind::kGain:
      return {1e-4, 0.3};
    case Kind::kPassiveKnee:
      return {0.0, 2.0};
    case Kind::kElasticity: {
      const double per_inertia = effect.p[0] / effect.p[1];
      return {0.05 * inertia * per_inertia, 0.6 * inertia * per_inertia};
    }
    case Kind::kBacklash:
      return {5e-4, 0.15};
    case Kind::kLag:
      return {3e-4, 0.03};
    case Kind::kDelay:
      return {1e-4, 0.025};
    case Kind::kOffset:
      return {1e-4, 0.1};
    case Kind::kVaryingInertia:
      return {0.0, 0.5 * inertia};
    case Kind::kWeakeningDrive:
    case Kind::kDeratingDrive:
      return {1e-4, 0.5};
    default:
      return {0.0, kUnlimited};
  }
}

}  // namespace patella::bench
