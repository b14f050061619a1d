#include "tools/studies/recordings/pendulum_study.hpp"

#include <cmath>
#include <numbers>
#include <span>

#include "core/model/model_description.hpp"
#include "tools/convert/time_base.hpp"

namespace patella::study {

using namespace offline;
namespace {

using convert::Interpolation;

// Wide enough for the motion and its reversals; what lies above is encoder steps.
constexpr double kPosition_Hz = 40.0;
constexpr double kLongestFilterLag_s = 0.2;
// Filters of both sides settle at the ends.
constexpr double kEdge_s = 0.5;
constexpr double kMoving_rad_s = 0.5;
constexpr double kHangingToHorizontal_rad = -0.5 * std::numbers::pi;

/// The recording on the grid that the converter makes, angles as the model counts them.
struct Motion {
  Samples time_s;
  std::array<Samples, 2> q_rad, dq_rad_s, ddq_rad_s2, torque_Nm;
};

Motion resampledMotion(const app::CsvTable& recording, double rate_Hz) {
  const convert::TimeBase base = convert::cleanTime(recording.column("t_s"));
  Motion motion;
  motion.time_s = convert::uniformGrid(base, rate_Hz);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const std::string number = std::to_string(joint + 1);
    const Samples raw = convert::resample(base, recording.column("q" + number + "_rad"), motion.time_s,
                                          Interpolation::kCubic);
    motion.q_rad[joint] = zeroPhaseLowPass(raw, kPosition_Hz, rate_Hz);
    motion.dq_rad_s[joint] = derivative(motion.q_rad[joint], rate_Hz);
    motion.ddq_rad_s2[joint] = derivative(motion.dq_rad_s[joint], rate_Hz);
    motion.torque_Nm[joint] = convert::resample(base, recording.column("tau" + number + "_Nm"), motion.time_s,
                                                Interpolation::kLinear);
  }
  for (double& angle : motion.q_rad[0]) {
    angle += kHangingToHorizontal_rad;
  }
  return motion;
}

std::array<Samples, 2> residual(const Motion& motion, const model::DynamicsModel& dynamics) {
  std::array<Samples, 2> result;
  for (std::size_t k = 0; k < motion.time_s.size(); ++k) {
    const auto at = [&](const std::array<Samples, 2>& values) {
      JointVector vector(2);
      vector << values[0][k], values[1][k];
      return vector;
    };
    model::EffectInput input;
    input.q = at(motion.q_rad);
    input.dq = at(motion.dq_rad_s);
    input.torque_Nm = at(motion.torque_Nm);
    const JointVector needed = dynamics.inverseDynamics(input, at(motion.ddq_rad_s2));
    for (std::size_t joint = 0; joint < 2; ++joint) {
      result[joint].push_back(needed[static_cast<Eigen::Index>(joint)] - motion.torque_Nm[joint][k]);
    }
  }
  return result;
}

/// Both second-order Butterworth filters delay slow signals by √2/ω; the sampler's value belongs to the
/// middle of its step.
double causalDelay(const tick::TickSettings& settings) {
  const auto filterDelay = [](double cutoff_Hz) {
    return std::numbers::sqrt2 / (2.0 * std::numbers::pi * cutoff_Hz);
  };
  return filterDelay(settings.estimate_cutoff_Hz) + filterDelay(settings.velocity_cutoff_Hz) +
         0.5 * settings.encoder_period_s;
}

Samples inner(const Samples& signal, double rate_Hz) {
  const auto edge = static_cast<std::ptrdiff_t>(kEdge_s * rate_Hz);
  return {signal.begin() + edge, signal.end() - edge};
}

double friction(std::span<const double> torque_Nm, std::span<const double> rate_rad_s) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < torque_Nm.size(); ++k) {
    if (std::abs(rate_rad_s[k]) > kMoving_rad_s) {
      sum -= torque_Nm[k] * std::copysign(1.0, rate_rad_s[k]);
      ++count;
    }
  }
  return sum / count;
}

void compare(JointComparison& c, double delay_s, double rate_Hz) {
  c.aligned_Nm = advanced(c.loop_Nm, delay_s, rate_Hz);
  for (Samples* signal : {&c.loop_Nm, &c.aligned_Nm, &c.offline_Nm, &c.rate_rad_s}) {
    *signal = inner(*signal, rate_Hz);
  }
  c.correlation_delayed = correlation(c.offline_Nm, c.loop_Nm);
  c.correlation_aligned = correlation(c.offline_Nm, c.aligned_Nm);
  c.rms_loop_Nm = rms(c.loop_Nm);
  c.rms_offline_Nm = rms(c.offline_Nm);
  c.rms_difference_delayed_Nm = rms(difference(c.loop_Nm, c.offline_Nm));
  c.rms_difference_aligned_Nm = rms(difference(c.aligned_Nm, c.offline_Nm));
  c.measured_delay_s = correlationPeak(c.offline_Nm, c.loop_Nm, rate_Hz, kLongestFilterLag_s).lag_s;
  c.friction_loop_Nm = friction(c.aligned_Nm, c.rate_rad_s);
  c.friction_offline_Nm = friction(c.offline_Nm, c.rate_rad_s);
}

}  // namespace

const std::vector<std::string>& recordedPendulumRuns() {
  static const std::vector<std::string> kRuns{"run_1", "run_2", "run_3"};
  return kRuns;
}

PendulumStudy studyPendulum(const Folders& folders, const std::string& run) {
  const std::filesystem::path file = folders.data / "double_pendulum" / (run + ".csv");
  const auto log = convertRecording(folders, file, "double_pendulum", run);
  const app::RunConfig config = loadConfig(folders, "double_pendulum", "replay:" + log.string());
  const app::CsvTable ticks = runRecording(folders, config, run);

  PendulumStudy study;
  study.run = run;
  study.rate_Hz = config.loop.rate_Hz;
  study.delay_s = causalDelay(config.tick);
  Motion motion = resampledMotion(app::CsvTable::load(file), study.rate_Hz);
  const auto offline = residual(motion, model::makeModel(config.model));
  study.time_s = std::move(motion.time_s);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    JointComparison& comparison = study.joint[joint];
    const auto loop = ticks.column("d_hat" + std::to_string(joint + 1) + "_Nm");
    comparison.loop_Nm.assign(loop.begin(), loop.end());
    comparison.loop_Nm.resize(study.time_s.size(), loop.back());
    comparison.offline_Nm = zeroPhaseLowPass(offline[joint], config.tick.estimate_cutoff_Hz, study.rate_Hz);
    comparison.rate_rad_s = motion.dq_rad_s[joint];
    compare(comparison, study.delay_s, study.rate_Hz);
  }
  study.time_s = inner(study.time_s, study.rate_Hz);
  return study;
}

}  // namespace patella::study
