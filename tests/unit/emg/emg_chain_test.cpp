#include "core/emg/emg_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <doctest/doctest.h>

#include "core/signal/butterworth.hpp"
#include "tests/support/allocation_counter.hpp"

using patella::EmgArray;
using patella::emg::EmgChain;
using patella::emg::EmgSettings;

namespace {

constexpr double kRate_Hz = 1000.0;
constexpr double kNoise_mV = 0.5;
/// Mean of the rectified noise below: E|x| = σ √(2/π).
const double kMvc_mV = kNoise_mV * std::sqrt(2.0 / std::numbers::pi);

constexpr double kBurstStart_s = 1.0;
constexpr double kBurstEnd_s = 2.0;
constexpr double kDuration_s = 3.0;

struct Scene {
  double offset_mV = 0.0;
  double hum_mV = 0.0;
  bool muscle = true;
  unsigned seed = 7;
};

/// Band-limited noise of unit variance in the burst, a little baseline outside, plus what electrodes add.
std::vector<double> syntheticEmg(const Scene& scene) {
  std::mt19937 generator(scene.seed);
  std::normal_distribution<double> white;
  auto shaping = patella::signal::bandPass(2, 60.0, 200.0, kRate_Hz);
  // Variance of white noise behind a band of 140 of 500 Hz with Butterworth flanks of second order.
  const double normalisation = 1.0 / std::sqrt(140.0 / 500.0 * 1.11);
  std::vector<double> signal;
  for (int k = 0; k < static_cast<int>(kDuration_s * kRate_Hz); ++k) {
    const double t_s = k / kRate_Hz;
    const bool burst = scene.muscle && t_s >= kBurstStart_s && t_s < kBurstEnd_s;
    const double muscle = normalisation * shaping.step(white(generator)) * (burst ? kNoise_mV : 0.002);
    const double hum = scene.hum_mV * std::sin(2.0 * std::numbers::pi * 50.0 * t_s);
    signal.push_back(muscle + hum + scene.offset_mV);
  }
  return signal;
}

EmgSettings settings() {
  EmgSettings s;
  s.rate_Hz = kRate_Hz;
  s.channels = 1;
  s.channel[0].mvc_mV = kMvc_mV;
  return s;
}

std::vector<double> activations(const EmgSettings& s, const std::vector<double>& signal) {
  EmgChain chain(s);
  std::vector<double> result;
  for (const double sample : signal) {
    result.push_back(chain.update({sample}, 1).activation[0]);
  }
  return result;
}

double mean(const std::vector<double>& values, double from_s, double to_s) {
  double sum = 0.0;
  const auto first = static_cast<int>(from_s * kRate_Hz);
  const auto last = static_cast<int>(to_s * kRate_Hz);
  for (int k = first; k < last; ++k) {
    sum += values[static_cast<std::size_t>(k)];
  }
  return sum / (last - first);
}

double peak(const std::vector<double>& values, double from_s, double to_s) {
  const auto begin = values.begin();
  return *std::max_element(begin + static_cast<int>(from_s * kRate_Hz),
                           begin + static_cast<int>(to_s * kRate_Hz));
}

/// First time after `from_s` at which the activation is above (or below) a half, s.
double crossing(const std::vector<double>& values, double from_s, bool above) {
  for (auto k = static_cast<std::size_t>(from_s * kRate_Hz); k < values.size(); ++k) {
    if ((values[k] > 0.5) == above) {
      return static_cast<double>(k) / kRate_Hz;
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

TEST_CASE("activation follows a burst and stays near zero in silence") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const auto a = activations(settings(), syntheticEmg({.seed = seed}));
    CHECK(mean(a, 1.3, 2.0) == doctest::Approx(0.9).epsilon(0.15));
    CHECK(peak(a, 0.0, 1.0) < 0.02);
    CHECK(peak(a, 2.5, 3.0) < 0.02);
    const double rise_s = crossing(a, kBurstStart_s, true) - kBurstStart_s;
    const double fall_s = crossing(a, kBurstEnd_s, false) - kBurstEnd_s;
    CHECK(rise_s > 0.0);
    CHECK(rise_s < 0.08);
    CHECK(fall_s > 0.0);
    CHECK(fall_s < 0.12);
  }
}

TEST_CASE("an offset of the electrodes has no effect, not even at the start") {
  const auto clean = activations(settings(), syntheticEmg({}));
  const auto shifted = activations(settings(), syntheticEmg({.offset_mV = 150.0}));
  for (std::size_t k = 0; k < clean.size(); ++k) {
    REQUIRE(std::abs(shifted[k] - clean[k]) < 1e-9);
  }
}

TEST_CASE("the notch removes hum and leaves the muscle") {
  EmgSettings with_notch = settings();
  with_notch.mains_Hz = 50.0;
  const Scene hum{.hum_mV = 0.3, .muscle = false};
  CHECK(mean(activations(settings(), syntheticEmg(hum)), 1.5, 3.0) > 0.4);
  CHECK(mean(activations(with_notch, syntheticEmg(hum)), 1.5, 3.0) < 0.01);

  const double without = mean(activations(settings(), syntheticEmg({})), 1.3, 2.0);
  const double with = mean(activations(with_notch, syntheticEmg({.hum_mV = 0.3})), 1.3, 2.0);
  CHECK(with == doctest::Approx(without).epsilon(0.05));
}

TEST_CASE("shape bends activation upwards between its fixed ends") {
  EmgSettings curved = settings();
  curved.channel[0].shape = -2.0;
  const auto signal = syntheticEmg({});
  const auto linear = activations(settings(), signal);
  const auto bent = activations(curved, signal);
  for (std::size_t k = 0; k < linear.size(); ++k) {
    const double expected = (std::exp(-2.0 * linear[k]) - 1.0) / (std::exp(-2.0) - 1.0);
    REQUIRE(bent[k] == doctest::Approx(expected).epsilon(1e-9));
    REQUIRE(bent[k] >= linear[k] - 1e-12);
  }
}

TEST_CASE("resting level counts as zero") {
  EmgSettings s = settings();
  s.channel[0].rest_mV = 0.004;
  CHECK(peak(activations(s, syntheticEmg({.muscle = false})), 0.5, 3.0) == 0.0);
}

TEST_CASE("the twitch response delays by twice its time constant and keeps the level") {
  EmgSettings slow = settings();
  slow.twitch_s = 0.03;
  const auto signal = syntheticEmg({});
  const auto fast = activations(settings(), signal);
  const auto late = activations(slow, signal);
  // The area between a step and its response is step height times delay, at any sampling.
  double area = 0.0;
  for (std::size_t k = 1000; k < 1900; ++k) {
    area += (fast[k] - late[k]) / kRate_Hz;
  }
  CHECK(area / mean(fast, 1.3, 1.9) == doctest::Approx(0.06).epsilon(0.25));
  CHECK(mean(late, 1.4, 2.0) == doctest::Approx(mean(fast, 1.4, 2.0)).epsilon(0.1));
}

TEST_CASE("output holds without a new sample and lost samples are bridged") {
  const auto signal = syntheticEmg({});
  EmgChain chain(settings());
  EmgChain with_losses(settings());
  double difference = 0.0;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    const double a = chain.update({signal[k]}, 1).activation[0];
    CHECK(chain.update({1e3}, 0).activation[0] == a);
    if (k % 50 == 0) {
      with_losses.update({signal[k]}, k == 0 ? 1 : 2);
    } else if (k % 50 != 49) {
      with_losses.update({signal[k]}, 1);
    }
    difference = std::max(difference, std::abs(a - with_losses.output().activation[0]));
  }
  CHECK(difference < 0.1);
}

TEST_CASE("extreme input leaves finite activations within 0 and 1 and the chain recovers") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EmgSettings s = settings();
  s.mains_Hz = 50.0;
  s.twitch_s = 0.02;
  s.channel[0].shape = -3.0;
  EmgChain chain(s);
  const std::vector<double> hostile = {std::nan(""), kInfinity, -kInfinity, 1e308, -1e308, 1e-320, 0.0, 5.0};
  for (int k = 0; k < 4000; ++k) {
    const auto i = static_cast<std::size_t>(k) % hostile.size();
    const auto& out = chain.update({hostile[i]}, k % 3 == 0 ? std::numeric_limits<int>::max() : 1);
    REQUIRE(std::isfinite(out.envelope_mV[0]));
    REQUIRE(out.activation[0] >= 0.0);
    REQUIRE(out.activation[0] <= 1.0);
  }
  for (int k = 0; k < 3000; ++k) {
    chain.update({0.0}, 1);
  }
  CHECK(chain.output().activation[0] < 1e-3);
}

TEST_CASE("bypass hands the signed signal through, scaled") {
  EmgSettings s;
  s.bypass = true;
  s.channel[1].mvc_mV = 0.5;
  EmgChain chain(s);
  const auto& out = chain.update({-1.45, 0.7, 0.0, 3.0}, 1);
  CHECK(out.activation == EmgArray{-1.45, 1.4, 0.0, 3.0});
  CHECK(chain.update({std::nan(""), 0.7, 0.0, 3.0}, 1).activation[0] == -1.45);
}

TEST_CASE("reset forgets a burst") {
  EmgChain chain(settings());
  EmgChain fresh(settings());
  for (const double sample : syntheticEmg({})) {
    chain.update({sample}, 1);
  }
  chain.reset();
  CHECK(chain.output().activation[0] == 0.0);
  for (const double sample : syntheticEmg({.offset_mV = -20.0, .seed = 11})) {
    REQUIRE(chain.update({sample}, 1).activation[0] == fresh.update({sample}, 1).activation[0]);
  }
}

TEST_CASE("processing allocates nothing") {
  EmgSettings s = settings();
  s.channels = patella::kMaxEmgChannels;
  s.mains_Hz = 60.0;
  EmgChain chain(s);
  const auto before = patella::test::allocationCount();
  for (int k = 0; k < 100; ++k) {
    chain.update({0.1 * k, -0.2, 0.3, std::nan("")}, k % 4);
  }
  chain.reset();
  CHECK(patella::test::allocationCount() == before);
}

TEST_CASE("the upper edge gives way at low rates and settings out of range are refused by name") {
  EmgSettings s = settings();
  s.rate_Hz = 500.0;
  CHECK_NOTHROW(EmgChain{s});
  s.rate_Hz = 40.0;
  CHECK_THROWS_WITH_AS(EmgChain{s}, "emg.rate_Hz = 40, expected 50 to 20000", std::invalid_argument);
  s.rate_Hz = 50.0;
  s.band_low_Hz = 20.5;
  CHECK_THROWS_WITH_AS(EmgChain{s}, "emg.band_low_Hz = 20.5, expected 1 to 20.25", std::invalid_argument);
  s = settings();
  s.channel[0].shape = 0.5;
  CHECK_THROWS_WITH_AS(EmgChain{s}, "emg.channel[1].shape = 0.5, expected -3 to 0", std::invalid_argument);
  s = settings();
  s.channel[0].mvc_mV = 0.0;
  CHECK_THROWS_AS(EmgChain{s}, std::invalid_argument);
  s = settings();
  s.mains_Hz = 16.7;
  CHECK_THROWS_AS(EmgChain{s}, std::invalid_argument);
  s = settings();
  s.envelope_Hz = std::nan("");
  CHECK_THROWS_AS(EmgChain{s}, std::invalid_argument);
  s = settings();
  s.channels = 5;
  CHECK_THROWS_AS(EmgChain{s}, std::invalid_argument);
}
