#include "tools/studies/learning/leg_runs.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "core/model/presets.hpp"
#include "sim/encoder.hpp"
#include "sim/plant.hpp"

namespace patella::study {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kTrajectoryStream = 200;
constexpr std::uint64_t kPatientStream = 201;
constexpr std::uint64_t kTorqueErrorStream = 202;
constexpr int kTones = 3;

double between(sim::Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// The motion of one joint.
class Trajectory {
 public:
  Trajectory(double offset_rad, double speed_rad_s, sim::Random& random) : offset_rad_(offset_rad) {
    for (Tone& tone : tones_) {
      tone.rate_rad_s = 2.0 * kPi * between(random, 0.1, 1.2);
      tone.amplitude_rad = between(random, 0.3, 1.0) * speed_rad_s / (tone.rate_rad_s + 1.5);
      tone.phase_rad = between(random, 0.0, 2.0 * kPi);
    }
  }
  double position(double t) const {
    double sum = offset_rad_;
    for (const Tone& tone : tones_) {
      sum += tone.amplitude_rad * std::sin(tone.rate_rad_s * t + tone.phase_rad);
    }
    return sum;
  }
  double velocity(double t) const {
    double sum = 0.0;
    for (const Tone& tone : tones_) {
      sum += tone.amplitude_rad * tone.rate_rad_s * std::cos(tone.rate_rad_s * t + tone.phase_rad);
    }
    return sum;
  }

 private:
  struct Tone {
    double rate_rad_s;
    double amplitude_rad;
    double phase_rad;
  };
  double offset_rad_;
  std::array<Tone, kTones> tones_{};
};

model::DynamicsModel leg(double shank_share, bool friction) {
  model::LegPreset preset = model::physicalLeg();
  preset.parameters.mass_kg[1] *= shank_share;
  preset.parameters.inertia_kg_m2[1] *= shank_share;
  auto mechanism = std::make_unique<model::PlanarTwoLink>(preset.parameters);
  std::vector<std::unique_ptr<model::Effect>> effects;
  for (int joint = 0; joint < 2; ++joint) {
    const double viscous = preset.viscous_Nms_rad + (friction ? 0.03 : 0.0);
    effects.push_back(model::makeEffect("viscous_friction", joint, *mechanism, std::array{viscous}));
    if (friction) {
      const double level_Nm = joint == 0 ? 0.08 : 0.05;
      effects.push_back(model::makeEffect("coulomb_friction", joint, *mechanism, std::array{level_Nm, 0.02}));
    }
  }
  return {std::move(mechanism), std::move(effects)};
}

}  // namespace

Recording recordLeg(const LegRunOptions& options, std::uint64_t seed) {
  const Eigen::Vector2d stiffness_Nm_rad(20.0, 15.0);
  const Eigen::Vector2d damping_Nms_rad(2.0, 1.0);
  sim::Random of_trajectory(seed, kTrajectoryStream);
  const std::array trajectory{Trajectory(-kPi / 2.0 + between(of_trajectory, 0.0, 0.6), 1.6, of_trajectory),
                              Trajectory(between(of_trajectory, -1.3, -0.5), 2.2, of_trajectory)};
  sim::Random of_patient(seed, kPatientStream);
  sim::InteractionOptions push{.kind = options.passive ? sim::InteractionKind::kNone
                                                       : sim::InteractionKind::kHuman};
  push.human_rms_N = between(of_patient, 0.5, 2.0);
  push.human_bandwidth_Hz = between(of_patient, 0.4, 2.0);
  const double own = between(of_patient, -1.0, 1.0);
  const double share = 1.0 + options.error.shank * (options.error.individual ? own : 1.0);

  const bool friction = options.error.friction;
  const Eigen::Vector2d start(trajectory[0].position(0.0), trajectory[1].position(0.0));
  sim::Plant plant(leg(1.0, friction), leg(1.0, friction), push, seed, {start, Eigen::Vector2d::Zero()},
                   5e-4);
  const model::DynamicsModel truth = leg(1.0, friction);
  sim::Random torque_error(seed, kTorqueErrorStream);
  sim::EncoderOptions encoder_options;
  encoder_options.bits_per_turn = kEncoderBits;
  std::array encoder{sim::Encoder(encoder_options, 0, seed), sim::Encoder(encoder_options, 1, seed)};

  Recording recording{.condition = {.experiment = sim::PaperExperiment::kFirst, .noise = Noise::kEncoderOnly},
                      .samples = {},
                      .known = [share] { return leg(share, false); }};
  const auto steps = static_cast<std::size_t>(std::llround(options.seconds * kRate_Hz));
  JointVector commanded = JointVector::Zero(2);
  for (std::size_t k = 0; k <= steps; ++k) {
    const sim::PlantState state = plant.state();
    const JointVector push_Nm = truth.mechanism().inertia(state.q) * plant.unknownDynamics();
    RecordedSample sample{state.q, JointVector::Zero(2), commanded, push_Nm};
    const double t = static_cast<double>(k) / kRate_Hz;
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      sample.q[i] = encoder[joint].measurePosition(state.q[i]);
      commanded[i] = stiffness_Nm_rad[i] * (trajectory[joint].position(t) - state.q[i]) +
                     damping_Nms_rad[i] * (trajectory[joint].velocity(t) - state.dq[i]);
    }
    recording.samples.push_back(sample);
    JointVector applied = commanded;
    for (double& torque : applied) {
      torque += kTorqueNoise_Nm * torque_error.gaussian();
    }
    plant.advance(applied, {}, 1.0 / kRate_Hz);
  }
  return recording;
}

std::vector<Recording> recordLegs(const LegRunOptions& options, std::uint64_t first, int count) {
  std::vector<Recording> recordings;
  for (int i = 0; i < count; ++i) {
    recordings.push_back(recordLeg(options, first + static_cast<std::uint64_t>(i)));
  }
  return recordings;
}

}  // namespace patella::study
