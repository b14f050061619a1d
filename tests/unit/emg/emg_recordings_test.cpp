// Seated knee extension of five people (UCI, "EMG Dataset in Lower Limb"): the envelope must tell when the
// quadriceps works, with nothing tuned to the person.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/emg/emg_chain.hpp"
#include "tools/checkout/checkout.hpp"

using patella::EmgArray;

namespace {

constexpr std::size_t kRectusFemoris = 0;
constexpr std::size_t kBicepsFemoris = 1;
constexpr std::size_t kVastusMedialis = 2;
constexpr std::size_t kSemitendinosus = 3;

struct Envelopes {
  std::vector<double> flexion_deg;
  std::vector<EmgArray> envelope_mV;
};

Envelopes load(const std::string& name) {
  std::ifstream file(patella::checkout::recordings() / "leg_emg" / (name + ".csv"));
  REQUIRE(file.is_open());
  patella::emg::EmgSettings settings;
  settings.mains_Hz = 50.0;
  patella::emg::EmgChain chain(settings);
  Envelopes result;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double t_s = 0.0;
    double knee_deg = 0.0;
    EmgArray emg_mV{};
    REQUIRE((row >> t_s >> emg_mV[0] >> emg_mV[1] >> emg_mV[2] >> emg_mV[3] >> knee_deg));
    result.envelope_mV.push_back(chain.update(emg_mV, 1).envelope_mV);
    // The goniometer's sign differs between files; a straight knee reads near zero in all.
    result.flexion_deg.push_back(std::abs(knee_deg));
  }
  REQUIRE(result.flexion_deg.size() > 10000);
  return result;
}

double correlationWithExtension(const Envelopes& data, std::size_t channel) {
  const auto n = static_cast<double>(data.flexion_deg.size());
  double x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < data.flexion_deg.size(); ++k) {
    const double extension = -data.flexion_deg[k];
    const double envelope = data.envelope_mV[k][channel];
    x += extension;
    y += envelope;
    xx += extension * extension;
    yy += envelope * envelope;
    xy += extension * envelope;
  }
  return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
}

/// Mean envelope in the most extended quarter of the range over that in the most flexed quarter.
double extendedOverFlexed(const Envelopes& data, std::size_t channel) {
  const auto [low, high] = std::minmax_element(data.flexion_deg.begin(), data.flexion_deg.end());
  const double quarter = 0.25 * (*high - *low);
  double extended = 0.0, flexed = 0.0;
  int extended_count = 0, flexed_count = 0;
  for (std::size_t k = 0; k < data.flexion_deg.size(); ++k) {
    if (data.flexion_deg[k] < *low + quarter) {
      extended += data.envelope_mV[k][channel];
      ++extended_count;
    } else if (data.flexion_deg[k] > *high - quarter) {
      flexed += data.envelope_mV[k][channel];
      ++flexed_count;
    }
  }
  return (extended / extended_count) / (flexed / flexed_count);
}

}  // namespace

TEST_CASE("quadriceps envelopes rise with knee extension in healthy people") {
  // Measured: correlations 0.69 to 0.76, ratios 4.35 to 25.4.
  for (const char* name : {"healthy_3", "healthy_4", "healthy_5"}) {
    CAPTURE(name);
    const Envelopes data = load(name);
    for (const std::size_t muscle : {kRectusFemoris, kVastusMedialis}) {
      CAPTURE(muscle);
      CHECK(correlationWithExtension(data, muscle) > 0.6);
      CHECK(extendedOverFlexed(data, muscle) > 3.5);
    }
  }
}

TEST_CASE("an impaired leg shows in the envelopes") {
  // Measured: rectus femoris 2.8 in both; in the second person the hamstrings hold the flexed knee (0.04,
  // 0.01).
  CHECK(extendedOverFlexed(load("impaired_1"), kRectusFemoris) > 2.0);
  const Envelopes second = load("impaired_2");
  CHECK(extendedOverFlexed(second, kRectusFemoris) > 2.0);
  CHECK(extendedOverFlexed(second, kBicepsFemoris) < 0.1);
  CHECK(extendedOverFlexed(second, kSemitendinosus) < 0.1);
}
