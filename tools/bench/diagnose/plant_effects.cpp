// What effects push and rub with; what changes the machine is mounted in plant.cpp.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/bench/diagnose/constants.hpp"
#include "tools/bench/diagnose/plant.hpp"

namespace patella::bench {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// Riener and Edrich 1999, the ankle at 0, without the stop of the straight knee: N·m that flexes.
double passiveKneeFlexing_Nm(double knee_flexion_deg, double hip_flexion_deg) {
  return std::exp(1.800 - 0.0352 * knee_flexion_deg + 0.0217 * hip_flexion_deg) -
         std::exp(-3.971 + 0.0495 * knee_flexion_deg - 0.0128 * hip_flexion_deg) - 4.820;
}

}  // namespace

Pair Plant::dryFriction(const TrueEffect& effect, const Instant& now) {
  const double q = now.q[effect.joint];
  const double dq = now.dq[effect.joint];
  const double drive_Nm = now.drive_Nm[effect.joint];
  const double time_s = now.time_s;
  const auto& p = effect.p;
  switch (effect.kind) {
    case Kind::kCoulomb:
      return {p[0], p[0]};
    case Kind::kAsymmetric:
      return {p[0], p[1]};
    case Kind::kStribeck: {
      const double level = p[0] + p[1] * std::exp(-square(dq / p[2]));
      return {level, level};
    }
    case Kind::kLoadDependent:
      return {p[0] * std::abs(drive_Nm), p[0] * std::abs(drive_Nm)};
    case Kind::kThermal: {
      const double level = p[1] * (1.0 - std::exp(-time_s / p[3]));
      return {level, level};
    }
    case Kind::kRubbingSpot: {
      const double level = p[0] * std::exp(-square((q - p[1]) / p[2]));
      return {level, level};
    }
    case Kind::kDraggingBrake: {
      constexpr double kShareOfTime = 1.0 / 3.0;
      const double place = time_s / p[1];
      const double level = place - std::floor(place) < kShareOfTime ? p[0] : 0.0;
      return {level, level};
    }
    default:
      return {};
  }
}

double Plant::signalAt(const std::vector<double>& signal, double time_s) const noexcept {
  if (signal.empty()) {
    return 0.0;
  }
  const double place = std::max(0.0, time_s / kTick_s);
  const auto before = std::min(static_cast<std::size_t>(place), signal.size() - 1);
  const std::size_t after = std::min(before + 1, signal.size() - 1);
  const double share = place - static_cast<double>(before);
  return signal[before] + std::min(share, 1.0) * (signal[after] - signal[before]);
}

double Plant::humanTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  switch (effect.kind) {
    case Kind::kPassiveKnee: {
      // Angles of the joints to flexions; a knee alone belongs to somebody seated.
      const double hip_deg = shape_ == Shape::kLeg ? 90.0 + kDegrees * now.q[0] : 90.0;
      return -p[0] * passiveKneeFlexing_Nm(-kDegrees * q, hip_deg);
    }
    case Kind::kTremor: {
      const double walk =
          p[3] > 0.0 ? signalAt(surroundings_->phase_walk, now.time_s) / std::sqrt(p[3]) : 0.0;
      return p[0] * std::sin(kTurn * p[1] * now.time_s + p[2] + walk);
    }
    case Kind::kSpasticity: {
      memory.velocity.push_back(now.dq[effect.joint]);
      const auto back = static_cast<std::size_t>(std::lround(p[2] / step_s_));
      const std::size_t last = memory.velocity.size() - 1;
      return -p[3] * p[0] * std::max(0.0, p[3] * memory.velocity[last - std::min(back, last)] - p[1]);
    }
    case Kind::kEmg:
      return p[0] *
             signalAt(surroundings_->activation[static_cast<std::size_t>(p[1]) - 1], now.time_s - p[2]);
    case Kind::kEmgStiffness:
      return -p[0] * signalAt(surroundings_->activation[static_cast<std::size_t>(p[2]) - 1], now.time_s) *
             (q - p[1]);
    case Kind::kBiarticular:
      return -p[0] * (now.q[1 - effect.joint] - p[1]);
    default:
      return 0.0;
  }
}

double Plant::defectTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  const double dq = now.dq[effect.joint];
  const double drive_Nm = now.drive_Nm[effect.joint];
  switch (effect.kind) {
    case Kind::kLoadTakenUp:
      return now.time_s > p[1] ? p[0] : 0.0;
    case Kind::kRelaxingTissue:
      memory.stretch += step_s_ * (dq - memory.stretch / p[1]);
      return -p[0] * memory.stretch;
    case Kind::kEccentricBearing:
      return -p[0] * (1.0 + std::sin(kTurn * p[1] * q + p[2])) * dq;
    case Kind::kSnaggingCable: {
      constexpr double kComesBack = 0.3;
      const double pull = p[0] * std::max(0.0, p[2] * (q - p[1]));
      return -p[2] * pull * (p[2] * dq > 0.0 ? 1.0 : kComesBack);
    }
    case Kind::kWeakeningDrive:
      return -p[0] * drive_Nm * std::min(1.0, std::abs(dq) / p[1]);
    case Kind::kDeadZone:
      return -std::clamp(drive_Nm, -p[0], p[0]);
    case Kind::kDeratingDrive:
      return -p[0] * (1.0 - std::exp(-now.time_s / p[1])) * drive_Nm;
    default:
      return 0.0;
  }
}

double Plant::softTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  const double dq = now.dq[effect.joint];
  switch (effect.kind) {
    case Kind::kViscous:
      return -p[0] * dq;
    case Kind::kAsymmetric:
      return -(dq > 0.0 ? p[2] : p[3]) * dq;
    case Kind::kPresliding: {
      const double bristle = (memory.bristle + step_s_ * dq) / (1.0 + step_s_ * p[1] * std::abs(dq) / p[0]);
      const double rate = (bristle - memory.bristle) / step_s_;
      memory.bristle = bristle;
      return -(p[1] * bristle + p[2] * rate);
    }
    case Kind::kStiffness:
      return -p[0] * (q - p[1]);
    case Kind::kRipple:
      return p[0] * std::sin(kTurn * p[1] * q + p[2]);
    case Kind::kBias:
      return p[0];
    case Kind::kThermal:
      return (1.0 - std::exp(-now.time_s / p[3])) * (p[0] - p[2] * dq);
    case Kind::kCubicDrag:
      return -p[0] * dq * dq * dq;
    case Kind::kVaryingInertia:
      return 0.5 * p[0] * std::sin(q) * dq * dq;
    case Kind::kContact:
      return -p[2] * p[0] * std::max(0.0, p[2] * (q - p[1]));
    case Kind::kVaryingStiffness:
      return -p[0] * (1.0 + std::sin(kTurn * p[2] * now.time_s)) * (q - p[1]);
    case Kind::kHardeningSpring:
      return -p[0] * (q - p[1]) * (q - p[1]) * (q - p[1]);
    default:
      return effect.info().defect ? defectTorque(effect, memory, now) : humanTorque(effect, memory, now);
  }
}

}  // namespace patella::bench
