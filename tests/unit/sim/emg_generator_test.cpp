#include "sim/emg_generator.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::sim;

namespace {

constexpr double kRate_Hz = 1000.0;

JointVector still() {
  return JointVector::Zero(2);
}

std::vector<double> record(const EmgOptions& options, std::uint64_t seed, int samples, std::size_t channel) {
  EmgGenerator emg(options, kRate_Hz, 2, seed);
  std::vector<double> signal;
  for (int i = 0; i < samples; ++i) {
    emg.advance(i / kRate_Hz, still());
    signal.push_back(emg.signal()[channel]);
  }
  return signal;
}

/// Power of `signal` at `frequency_Hz`, averaged over segments of 500 samples (2 Hz resolution), Hann window.
double powerAt(const std::vector<double>& signal, double frequency_Hz) {
  constexpr int kSegment = 500;
  double power = 0.0;
  for (std::size_t start = 0; start + kSegment <= signal.size(); start += kSegment) {
    std::complex<double> sum = 0.0;
    for (int i = 0; i < kSegment; ++i) {
      const double hann = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * i / kSegment));
      sum += signal[start + static_cast<std::size_t>(i)] * hann *
             std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * i / kRate_Hz);
    }
    power += std::norm(sum);
  }
  return power;
}

double rms(const std::vector<double>& x) {
  double squares = 0.0;
  for (const double value : x) {
    squares += value * value;
  }
  return std::sqrt(squares / static_cast<double>(x.size()));
}

EmgOptions alwaysOn() {
  EmgChannelOptions channel;
  channel.duty = 1.0;
  channel.period_s = 1000.0;
  channel.phase = 0.5;
  channel.baseline_mV = 0.0;
  EmgOptions options;
  options.channels = {channel};
  return options;
}

}  // namespace

TEST_CASE("the power of an active muscle lies between 20 and 450 Hz and its rms is the asked one") {
  const std::vector<double> signal = record(alwaysOn(), 5, 20'000, 0);
  double inside = 0.0;
  double outside = 0.0;
  for (double f = 0.0; f <= 500.0; f += 2.0) {
    (f >= 20.0 && f <= 450.0 ? inside : outside) += powerAt(signal, f);
  }
  CHECK(outside / inside < 0.02);
  // Far outside almost nothing remains; inside the band the spectrum is flat.
  CHECK(powerAt(signal, 4.0) / powerAt(signal, 100.0) < 1e-3);
  CHECK(powerAt(signal, 300.0) / powerAt(signal, 100.0) == doctest::Approx(1.0).epsilon(0.8));
  CHECK(rms(signal) == doctest::Approx(0.3).epsilon(0.03));
}

TEST_CASE("bursts stand out of the baseline, and antagonists are silent while agonists work") {
  EmgGenerator emg(scheduledEmg(2.0), kRate_Hz, 2, 1);
  std::vector<double> on;
  std::vector<double> off;
  double overlap = 0.0;
  double largest_jump = 0.0;
  EmgArray previous{};
  for (int i = 0; i < 20'000; ++i) {
    emg.advance(i / kRate_Hz, still());
    const EmgArray& a = emg.activation();
    if (a[0] == 1.0) {
      on.push_back(emg.signal()[0]);
    } else if (a[0] == 0.0) {
      off.push_back(emg.signal()[0]);
    }
    overlap += a[0] * a[1] + a[2] * a[3];
    for (std::size_t c = 0; c < a.size(); ++c) {
      largest_jump = i == 0 ? 0.0 : std::max(largest_jump, std::abs(a[c] - previous[c]));
    }
    previous = a;
  }
  CHECK(on.size() + off.size() > 10'000);
  CHECK(rms(on) / rms(off) > 30.0);
  CHECK(rms(off) == doctest::Approx(0.004).epsilon(0.05));
  CHECK(overlap == 0.0);
  CHECK(largest_jump < 0.02);
}

TEST_CASE("muscles that follow the motion work in its direction only") {
  EmgGenerator emg(movementEmg(), kRate_Hz, 2, 1);
  JointVector velocity(2);
  velocity << 0.6, -2.0;
  for (int i = 0; i < 2000; ++i) {
    emg.advance(i / kRate_Hz, velocity);
  }
  CHECK(emg.activation()[0] == doctest::Approx(0.6));
  CHECK(emg.activation()[1] == 0.0);
  CHECK(emg.activation()[2] == 0.0);
  CHECK(emg.activation()[3] == doctest::Approx(1.0));
}

TEST_CASE("hum and offset are added, and the amplifier clips") {
  EmgOptions options = alwaysOn();
  options.channels[0].amplitude_mV = 0.0;
  options.channels[0].offset_mV = 0.2;
  options.channels[0].hum_mV = 0.1;
  const std::vector<double> quiet = record(options, 1, 1000, 0);
  CHECK(*std::max_element(quiet.begin(), quiet.end()) == doctest::Approx(0.3));
  CHECK(*std::min_element(quiet.begin(), quiet.end()) == doctest::Approx(0.1));

  options.channels[0].amplitude_mV = 5.0;
  const std::vector<double> loud = record(options, 1, 1000, 0);
  CHECK(*std::max_element(loud.begin(), loud.end()) == 1.5);
  CHECK(*std::min_element(loud.begin(), loud.end()) == -1.5);
}

TEST_CASE("a seed repeats to the bit, and a channel does not depend on the others") {
  const std::vector<double> a = record(scheduledEmg(), 9, 3000, 1);
  CHECK(a == record(scheduledEmg(), 9, 3000, 1));
  CHECK(a != record(scheduledEmg(), 10, 3000, 1));
  EmgOptions changed = scheduledEmg();
  changed.channels[0].amplitude_mV = 0.0;
  CHECK(a == record(changed, 9, 3000, 1));
}

TEST_CASE("the paper's calibrated torque has its rms and peaks") {
  EmgGenerator emg(paperEmg(), kRate_Hz, 2, 1);
  JointVector squares = JointVector::Zero(2);
  JointVector peak = JointVector::Zero(2);
  constexpr int kSamples = 50'000;
  for (int i = 0; i < kSamples; ++i) {
    emg.advance(i / kRate_Hz, still());
    const JointVector torque = paperTorque(emg.activation());
    squares += torque.cwiseAbs2() / kSamples;
    peak = peak.cwiseMax(torque.cwiseAbs());
  }
  CHECK(std::sqrt(squares(0)) == doctest::Approx(0.59).epsilon(0.02));
  CHECK(std::sqrt(squares(1)) == doctest::Approx(0.28).epsilon(0.02));
  CHECK(peak(0) == doctest::Approx(1.45).epsilon(0.01));
  CHECK(peak(1) == doctest::Approx(0.70).epsilon(0.01));
}

TEST_CASE("options out of range are refused, naming the channel") {
  EmgOptions options = scheduledEmg();
  options.channels[2].duty = 1.5;
  CHECK_THROWS_WITH_AS(EmgGenerator(options, kRate_Hz, 2, 1),
                       "emg channel 3: duty is out of range, expected 0 to 1", std::invalid_argument);
  CHECK_THROWS_AS(EmgGenerator(movementEmg(), kRate_Hz, 1, 1), std::invalid_argument);
  CHECK_THROWS_AS(EmgGenerator(scheduledEmg(), 800.0, 2, 1), std::invalid_argument);
  options.channels.resize(5);
  CHECK_THROWS_AS(EmgGenerator(options, kRate_Hz, 2, 1), std::invalid_argument);
}
