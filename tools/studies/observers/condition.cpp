#include "tools/studies/observers/condition.hpp"

#include <cmath>
#include <numbers>

#include "core/model/presets.hpp"
#include "sim/encoder.hpp"
#include "sim/plant.hpp"
#include "sim/random.hpp"

namespace patella::study {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kTorqueErrorStream = 100;

struct Reference {
  Eigen::Vector2d q;
  Eigen::Vector2d dq;
};

Reference referenceAt(double t) {
  const double first = kPi * t;
  const double second = kPi * t + 0.8;
  return {{-kPi / 2.0 + 0.4 + 0.35 * std::sin(first), -0.9 + 0.45 * std::sin(second)},
          {0.35 * kPi * std::cos(first), 0.45 * kPi * std::cos(second)}};
}

sim::EncoderOptions encoderOptions(const Condition& condition) {
  sim::EncoderOptions options;
  if (condition.encoderOnly()) {
    options.bits_per_turn = kEncoderBits;
    return options;
  }
  options.velocity_noise_sd_rad_s = kStateNoise;
  options.position_noise_sd_rad = condition.noise == Noise::kBothStates ? kStateNoise : 0.0;
  return options;
}

std::array<sim::Encoder, 2> encoders(const sim::EncoderOptions& options, std::uint64_t seed) {
  return {sim::Encoder(options, 0, seed), sim::Encoder(options, 1, seed)};
}

Recording recordPaper(const Condition& condition, double seconds, std::uint64_t seed) {
  auto encoder = encoders(encoderOptions(condition), seed);
  Recording recording{.condition = condition, .samples = {}, .known = {}};
  for (const sim::PaperSample& sample :
       sim::runPaperExperiment(condition.experiment, kRate_Hz, seconds, seed, condition.push_begun_s)) {
    RecordedSample out{sample.q, sample.dq, sample.torque_Nm, sample.f_u};
    for (std::size_t joint = 0; joint < encoder.size(); ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      out.q[i] = encoder[joint].measurePosition(sample.q[i]);
      out.dq[i] = encoder[joint].measureVelocity(sample.dq[i]);
    }
    recording.samples.push_back(out);
  }
  return recording;
}

Recording recordPhysical(const Condition& condition, double seconds, std::uint64_t seed) {
  const Eigen::Vector2d stiffness_Nm_rad(20.0, 15.0);
  const Eigen::Vector2d damping_Nms_rad(2.0, 1.0);
  const model::DynamicsModel known = knownModel(condition);
  const Reference start = referenceAt(0.0);
  sim::InteractionOptions interaction;
  interaction.kind = condition.experiment == sim::PaperExperiment::kFirst
                         ? sim::InteractionKind::kExperiment1
                         : sim::InteractionKind::kExperiment2;
  interaction.begun_s = condition.push_begun_s;
  sim::Plant plant(knownModel(condition), knownModel(condition), interaction, seed, {start.q, start.dq});
  sim::Random torque_error(seed, kTorqueErrorStream);
  const auto emg_torque = sim::paperTorques(seed);
  auto encoder = encoders(encoderOptions(condition), seed);

  Recording recording{.condition = condition, .samples = {}, .known = {}};
  const auto steps = static_cast<std::size_t>(std::llround(seconds * kRate_Hz));
  JointVector commanded = JointVector::Zero(2);
  for (std::size_t k = 0; k <= steps; ++k) {
    const sim::PlantState state = plant.state();
    const JointVector d_Nm = known.mechanism().inertia(state.q) * plant.unknownDynamics();
    RecordedSample out{state.q, JointVector::Zero(2), commanded, d_Nm};
    for (std::size_t joint = 0; joint < encoder.size(); ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      out.q[i] = encoder[joint].measurePosition(state.q[i]);
      out.dq[i] = condition.encoderOnly() ? 0.0 : encoder[joint].measureVelocity(state.dq[i]);
    }
    recording.samples.push_back(out);
    const double time_s = static_cast<double>(k) / kRate_Hz;
    const Reference wanted = referenceAt(time_s);
    commanded = stiffness_Nm_rad.cwiseProduct(wanted.q - state.q) +
                damping_Nms_rad.cwiseProduct(wanted.dq - state.dq);
    JointVector applied = commanded;
    for (std::size_t joint = 0; joint < encoder.size(); ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      if (condition.encoderOnly()) {
        applied[i] += kTorqueNoise_Nm * torque_error.gaussian();
      } else {
        commanded[i] += emg_torque[joint].at(time_s);
        applied[i] = commanded[i];
      }
    }
    plant.advance(applied, {}, 1.0 / kRate_Hz);
  }
  return recording;
}

}  // namespace

std::string_view noiseName(Noise noise) {
  switch (noise) {
    case Noise::kVelocity:
      return "velocity";
    case Noise::kBothStates:
      return "both_states";
    case Noise::kEncoderOnly:
      break;
  }
  return "encoder_only";
}

model::DynamicsModel knownModel(const Condition& condition) {
  return makeModel(condition.corrected ? model::physicalLeg() : model::paperLeg());
}

Recording record(const Condition& condition, double seconds, std::uint64_t seed) {
  return condition.corrected ? recordPhysical(condition, seconds, seed)
                             : recordPaper(condition, seconds, seed);
}

}  // namespace patella::study
