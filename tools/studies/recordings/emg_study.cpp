#include "tools/studies/recordings/emg_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tools/studies/recordings/onset.hpp"

namespace patella::study {

using namespace offline;
namespace {

constexpr double kRate_Hz = 1000.0;
// The goniometer was sampled at 50 Hz and held; this removes the steps.
constexpr double kGoniometer_Hz = 8.0;
constexpr double kLongestEmgLag_s = 1.0;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<const char*, kMaxEmgChannels> kChannels{
    "emg_rectus_femoris_mV", "emg_biceps_femoris_mV", "emg_vastus_medialis_mV", "emg_semitendinosus_mV"};

Samples column(const app::CsvTable& table, const char* name) {
  const auto values = table.column(name);
  return {values.begin(), values.end()};
}

Samples scaled(Samples signal, double factor) {
  for (double& value : signal) {
    value *= factor;
  }
  return signal;
}

/// A knee rests where it is in the lowest fifth of its range and slower than a twentieth of its top speed.
std::vector<bool> restingSamples(const Samples& motion, const Samples& rate) {
  const double low = quantile(motion, 0.02);
  const double high = low + 0.2 * (quantile(motion, 0.98) - low);
  std::vector<bool> resting(motion.size());
  const double slow = 0.05 * std::max(quantile(rate, 0.98), -quantile(rate, 0.02));
  std::transform(motion.begin(), motion.end(), rate.begin(), resting.begin(),
                 [&](double m, double r) { return m < high && std::abs(r) < slow; });
  return resting;
}

/// Onsets of effort and of motion in its direction, movement by movement. A movement that began before the
/// recording is left out.
std::vector<Onset> findOnsets(const Samples& effort, const Samples& motion) {
  const OnsetRule rule;
  const Samples rate = derivative(motion, kRate_Hz);
  const std::vector<bool> resting = restingSamples(motion, rate);
  const double effort_threshold = onsetThreshold(effort, resting, rule);
  const double rate_threshold = onsetThreshold(rate, resting, rule);
  std::vector<Onset> onsets;
  for (const std::size_t under_way : risesThroughMiddle(motion)) {
    const auto moved = onsetBefore(rate, under_way, rate_threshold, kRate_Hz, rule);
    const auto worked = onsetBefore(effort, under_way, effort_threshold, kRate_Hz, rule);
    if (moved && worked) {
      onsets.push_back({static_cast<double>(*worked) / kRate_Hz, static_cast<double>(*moved) / kRate_Hz});
    }
  }
  return onsets;
}

}  // namespace

const std::vector<std::string>& recordedPeople() {
  static const std::vector<std::string> kPeople{"healthy_3", "healthy_4", "healthy_5", "impaired_1",
                                                "impaired_2"};
  return kPeople;
}

void calibrate(emg::EmgSettings& settings, const app::CsvTable& recording) {
  emg::EmgChain chain(settings);
  std::array<Samples, kMaxEmgChannels> envelopes;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    EmgArray sample_mV{};
    for (std::size_t i = 0; i < kChannels.size(); ++i) {
      sample_mV[i] = recording.column(kChannels[i])[row];
    }
    const EmgArray& envelope = chain.update(sample_mV, 1).envelope_mV;
    for (std::size_t i = 0; i < kChannels.size(); ++i) {
      envelopes[i].push_back(envelope[i]);
    }
  }
  double full_mV = 0.0;
  for (const Samples& envelope : envelopes) {
    full_mV = std::max(full_mV, quantile(envelope, 0.98));
  }
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    settings.channel[i].rest_mV = quantile(envelopes[i], 0.10);
    settings.channel[i].mvc_mV = full_mV;
  }
}

EmgStudy studyEmg(const Folders& folders, const std::string& person) {
  const std::filesystem::path file = folders.data / "leg_emg" / (person + ".csv");
  const app::CsvTable recording = app::CsvTable::load(file);
  app::RunConfig config = loadConfig(folders, "leg_emg", "sim");
  calibrate(config.tick.emg, recording);
  config.rig.emg_log = convertRecording(folders, file, "leg_emg", person);
  config.loop.max_ticks = recording.rows();
  const app::CsvTable ticks = runRecording(folders, config, person);
  if (ticks.column("state").back() != static_cast<double>(safety::State::kActive)) {
    throw std::runtime_error(person + ": the loop stopped assisting, expected it to last");
  }

  EmgStudy study;
  study.person = person;
  study.torque_Nm = column(ticks, "tau_emg2_Nm");
  study.simulated_knee_rad = column(ticks, "q2_rad");
  const Samples raw_rad = scaled(column(recording, "knee_deg"), kDegree);
  const Samples smooth_rad = zeroPhaseLowPass(raw_rad, kGoniometer_Hz, kRate_Hz);
  const Samples reversed_rad = scaled(smooth_rad, -1.0);
  const CorrelationPeak as_is = correlationPeak(study.torque_Nm, smooth_rad, kRate_Hz, kLongestEmgLag_s);
  const CorrelationPeak reversed = correlationPeak(study.torque_Nm, reversed_rad, kRate_Hz, kLongestEmgLag_s);
  study.goniometer_sign = as_is.correlation >= reversed.correlation ? 1 : -1;
  study.knee_rad = study.goniometer_sign > 0 ? smooth_rad : reversed_rad;
  study.angle = study.goniometer_sign > 0 ? as_is : reversed;
  study.velocity =
      correlationPeak(study.torque_Nm, derivative(study.knee_rad, kRate_Hz), kRate_Hz, kLongestEmgLag_s);
  study.simulated_angle_correlation = correlation(study.simulated_knee_rad, study.knee_rad);

  const auto [least, greatest] = std::minmax_element(study.torque_Nm.begin(), study.torque_Nm.end());
  study.flexion = -*least > *greatest;
  const double direction = study.flexion ? -1.0 : 1.0;
  study.onsets = findOnsets(scaled(study.torque_Nm, direction), scaled(study.knee_rad, direction));
  return study;
}

}  // namespace patella::study
