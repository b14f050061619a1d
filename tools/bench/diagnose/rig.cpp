#include "tools/bench/diagnose/rig.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tools/bench/diagnose/constants.hpp"
#include "tools/bench/diagnose/random.hpp"

namespace patella::bench {
namespace {

constexpr double kSwingIn_s = 2.0;
constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
// Streams of random numbers.
enum Stream : std::uint64_t { kPatient = 1, kMuscles, kSensors, kBus, kPhase };

// White noise through two equal first-order low-passes, scaled to its standard deviation.
std::vector<double> slowNoise(Random& random, double sd, double bandwidth_Hz, std::size_t count) {
  const double keep = std::exp(-kTurn * bandwidth_Hz * kTick_s);
  double first = 0.0, second = 0.0;
  std::vector<double> signal;
  signal.reserve(count);
  const auto settling = static_cast<std::size_t>(3.0 / (bandwidth_Hz * kTick_s));
  for (std::size_t i = 0; i < count + settling; ++i) {
    first = keep * first + (1.0 - keep) * random.normal();
    second = keep * second + (1.0 - keep) * first;
    if (i >= settling) {
      signal.push_back(second);
    }
  }
  // Variance of the cascade: (1−k)^4 (1+k²)/(1−k²)³.
  const double variance = std::pow(1.0 - keep, 4) * (1.0 + keep * keep) / std::pow(1.0 - keep * keep, 3);
  for (double& value : signal) {
    value *= sd / std::sqrt(variance);
  }
  return signal;
}

// A muscle: silent, then active for a while at some level, with slopes of 60 to 150 ms.
std::vector<double> bursts(Random& random, std::size_t count) {
  std::vector<double> activation(count, 0.0);
  double start_s = random.uniform(0.3, 2.0);
  while (start_s < static_cast<double>(count) * kTick_s) {
    const double length_s = random.uniform(0.3, 1.5);
    const double level = random.uniform(0.25, 0.85);
    const double rise_s = random.uniform(0.06, 0.15);
    for (std::size_t i = 0; i < count; ++i) {
      const double since_s = static_cast<double>(i) * kTick_s - start_s;
      const double edge = std::min(since_s, length_s - since_s) / rise_s;
      if (edge > 0.0) {
        const double x = std::min(edge, 1.0);
        activation[i] = std::max(activation[i], level * x * x * (3.0 - 2.0 * x));
      }
    }
    start_s += length_s + random.uniform(0.3, 2.5);
  }
  return activation;
}

Surroundings surroundingsOf(const Rig& rig, std::size_t count) {
  Surroundings around;
  Random patient(rig.seed, kPatient);
  constexpr double kShared = 0.4;  // what the joints have in common
  const std::vector<double> common = slowNoise(patient, 1.0, rig.human_bandwidth_Hz, count);
  for (std::size_t j = 0; j < rig.body.joints(); ++j) {
    around.human_Nm[j] = slowNoise(patient, 1.0, rig.human_bandwidth_Hz, count);
    for (std::size_t i = 0; i < count; ++i) {
      around.human_Nm[j][i] = rig.human_Nm[j] * (std::sqrt(1.0 - kShared * kShared) * around.human_Nm[j][i] +
                                                 kShared * common[i]);
    }
  }
  Random muscles(rig.seed, kMuscles);
  for (std::size_t channel = 0; channel < rig.emg_channels; ++channel) {
    around.activation[channel] = bursts(muscles, count);
  }
  Random phase(rig.seed, kPhase);
  around.phase_walk.reserve(count);
  double walk = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    around.phase_walk.push_back(walk);
    walk += std::sqrt(kTick_s) * phase.normal();
  }
  return around;
}

// Proportional and derivative action around the nominal torque of the reference. The rate comes from
// differences of the counted angle through a low-pass.
class Controller {
 public:
  Controller(const Rig& rig, std::span<const TrueEffect> effects) : rig_(&rig), nominal_(rig.nominal) {
    const double omega = kTurn * rig.control_bandwidth_Hz;
    PerJoint middle{};
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      middle[j] = rig.reference[j].centre_rad;
    }
    InverseDynamics unloaded(weightless(rig.nominal));
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      PerJoint unit{};
      unit[j] = 1.0;
      // A chain's corrections are accelerations: its inertia matrix is far from diagonal.
      const double inertia = isChain() ? 1.0 : unloaded(middle, {}, unit)[j];
      stiffness_[j] = inertia * omega * omega;
      damping_[j] = 2.0 * inertia * omega;
    }
    // Gains for motor and link together would drive a motor that has come loose into oscillation.
    constexpr double kSoftShare = 0.25;
    for (const TrueEffect& effect : effects) {
      if (effect.kind == Kind::kElasticity || effect.kind == Kind::kBacklash) {
        stiffness_[effect.joint] *= kSoftShare;
        damping_[effect.joint] *= kSoftShare;
      }
    }
  }

  PerJoint command(const Target& target, const PerJoint& counted) {
    constexpr double kRateFilter_Hz = 30.0;
    const double share = 1.0 - std::exp(-kTurn * kRateFilter_Hz * kTick_s);
    PerJoint correction{};
    for (std::size_t j = 0; j < rig_->body.joints(); ++j) {
      const double difference = has_last_ ? (counted[j] - last_[j]) / kTick_s : 0.0;
      rate_[j] += share * (difference - rate_[j]);
      correction[j] = stiffness_[j] * (target.q[j] - counted[j]) + damping_[j] * (target.dq[j] - rate_[j]);
    }
    last_ = counted;
    has_last_ = true;
    PerJoint acceleration = target.ddq;
    if (isChain()) {
      add(correction, acceleration);
      return nominal_(target.q, target.dq, acceleration);
    }
    PerJoint torque = nominal_(target.q, target.dq, acceleration);
    add(correction, torque);
    return torque;
  }

 private:
  bool isChain() const noexcept { return rig_->body.shape == Shape::kChain; }
  static void add(const PerJoint& more, PerJoint& to) noexcept {
    for (std::size_t j = 0; j < kJoints; ++j) {
      to[j] += more[j];
    }
  }

  const Rig* rig_;
  InverseDynamics nominal_;
  PerJoint stiffness_{}, damping_{}, last_{}, rate_{};
  bool has_last_ = false;
};

PerJoint counted(PerJoint angle, const PerJoint& step_rad) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (step_rad[j] > 0.0) {
      angle[j] = step_rad[j] * std::round(angle[j] / step_rad[j]);
    }
  }
  return angle;
}

// The rows as a loader reads them: straight lines between the positions that came, at equal times; a lost
// torque is held.
void resample(const Rig& rig, Run& run, std::size_t count) {
  diagnose::Recording& recording = run.recording;
  recording.rate_Hz = 1.0 / kTick_s;
  recording.joints = static_cast<int>(rig.body.joints());
  recording.torque_timing = diagnose::TorqueTiming::kHeld;
  recording.segments = {{.first = 0, .end = count}};
  for (std::size_t i = 0; i < count; ++i) {
    recording.time_s.push_back(static_cast<double>(i) * kTick_s);
  }
  for (std::size_t j = 0; j < rig.body.joints(); ++j) {
    std::vector<double> stamps, values;
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isfinite(run.raw_position_rad[j][i])) {
        stamps.push_back(run.stamp_s[i]);
        values.push_back(run.raw_position_rad[j][i]);
      }
    }
    std::size_t right = 1;
    double held_Nm = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double time_s = recording.time_s[i];
      while (right + 1 < stamps.size() && stamps[right] < time_s) {
        ++right;
      }
      const double share = (time_s - stamps[right - 1]) / (stamps[right] - stamps[right - 1]);
      recording.position_rad[j].push_back(values[right - 1] + share * (values[right] - values[right - 1]));
      held_Nm = std::isfinite(run.raw_torque_Nm[j][i]) ? run.raw_torque_Nm[j][i] : held_Nm;
      recording.torque_Nm[j].push_back(held_Nm);
    }
  }
}

void record(const Rig& rig, const Surroundings& around, Run& run) {
  const std::size_t count = run.command_Nm[0].size();
  Random sensors(rig.seed, kSensors);
  Random bus(rig.seed, kBus);
  for (std::size_t i = 0; i < count; ++i) {
    run.stamp_s.push_back(static_cast<double>(i) * kTick_s + bus.uniform(-rig.jitter_s, rig.jitter_s));
    PerJoint angle{};
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      angle[j] = run.encoder_rad[j][i];
    }
    angle = counted(angle, rig.encoder_step_rad);
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      const double torque_Nm = run.command_Nm[j][i] + rig.torque_noise_Nm[j] * sensors.normal();
      // The first row sets the loader going.
      const bool lost = bus.chance(rig.loss_probability) && i > 0;
      run.raw_position_rad[j].push_back(lost ? kLost : angle[j]);
      run.raw_torque_Nm[j].push_back(lost ? kLost : torque_Nm);
    }
  }
  resample(rig, run, count);
  for (std::size_t channel = 0; channel < rig.emg_channels; ++channel) {
    for (std::size_t i = 0; i < count; ++i) {
      run.recording.activation[channel].push_back(
          std::clamp(around.activation[channel][i] + rig.emg_noise * sensors.normal(), 0.0, 1.0));
    }
  }
}

}  // namespace

Target targetAt(const std::array<JointReference, kJoints>& reference, double time_s) {
  // Quintic smooth step and its derivatives.
  const double x = std::clamp(time_s / kSwingIn_s, 0.0, 1.0);
  const double w = x * x * x * (10.0 + x * (6.0 * x - 15.0));
  const double dw = 30.0 * x * x * (1.0 - x) * (1.0 - x) / kSwingIn_s;
  const double ddw = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (kSwingIn_s * kSwingIn_s);
  Target target;
  for (std::size_t j = 0; j < kJoints; ++j) {
    double s = 0.0, ds = 0.0, dds = 0.0;
    for (const Harmonic& harmonic : reference[j].harmonics) {
      const double omega = kTurn * harmonic.frequency_Hz;
      const double angle = omega * time_s + harmonic.phase_rad;
      const double sine = harmonic.amplitude_rad * std::sin(angle);
      s += sine;
      ds += harmonic.amplitude_rad * omega * std::cos(angle);
      dds -= omega * omega * sine;
    }
    target.q[j] = reference[j].centre_rad + w * s;
    target.dq[j] = dw * s + w * ds;
    target.ddq[j] = ddw * s + 2.0 * dw * ds + w * dds;
  }
  return target;
}

Run simulate(const Rig& rig, std::span<const TrueEffect> effects) {
  const auto count = static_cast<std::size_t>(std::lround(rig.duration_s / kTick_s));
  const Surroundings around = surroundingsOf(rig, count + 1);
  const Target start = targetAt(rig.reference, 0.0);
  Plant plant(rig.body, effects, around, start.q);
  Controller controller(rig, effects);
  Run run;
  for (std::size_t i = 0; i < count && run.stable; ++i) {
    const PerJoint seen = plant.encoder();
    const Target target = targetAt(rig.reference, static_cast<double>(i) * kTick_s);
    // The controller closes its loop on the motor: a rig with a soft transmission would sway otherwise.
    const PerJoint command = controller.command(target, counted(plant.motorPosition(), rig.encoder_step_rad));
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      run.encoder_rad[j].push_back(seen[j]);
      run.command_Nm[j].push_back(command[j]);
      run.human_Nm[j].push_back(around.human_Nm[j][i]);
      constexpr double kAstray_rad = 1.0;
      run.stable = run.stable && std::abs(seen[j] - target.q[j]) < kAstray_rad;
    }
    plant.advance(command);
  }
  record(rig, around, run);
  return run;
}

void writeCsv(const Run& run, const std::filesystem::path& path) {
  std::string text = "t_s";
  const auto joints = static_cast<std::size_t>(run.recording.joints);
  for (std::size_t j = 0; j < joints; ++j) {
    text += fmt::format(",q{}_rad", j + 1);
  }
  for (std::size_t j = 0; j < joints; ++j) {
    text += fmt::format(",tau{}_Nm", j + 1);
  }
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    text += run.recording.activation[channel].empty() ? "" : fmt::format(",activation{}", channel + 1);
  }
  const auto cell = [&](double value) { text += std::isfinite(value) ? fmt::format(",{:.9g}", value) : ","; };
  for (std::size_t i = 0; i < run.stamp_s.size(); ++i) {
    text += fmt::format("\n{:.6f}", run.stamp_s[i] + kTick_s);
    for (std::size_t j = 0; j < joints; ++j) {
      cell(run.raw_position_rad[j][i]);
    }
    for (std::size_t j = 0; j < joints; ++j) {
      cell(run.raw_torque_Nm[j][i]);
    }
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      if (!run.recording.activation[channel].empty()) {
        cell(run.recording.activation[channel][i]);
      }
    }
  }
  app::writeFile(path, text + "\n");
}

}  // namespace patella::bench
