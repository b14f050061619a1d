// A motion whose sinusoids lie too close to be told apart in a spectrum, as in recordings of a few periods.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tools/diagnose/diagnose.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

const model::ModelDescription kArm{
    .mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = 0.17, .moment_kg_m = 0.53, .length_m = 0.45},
    .effects = {}};

/// Torque that is recorded, from this motion's as a function of time.
using Drive = std::function<double(const std::function<double(double)>& torque_Nm, double time_s, double dq)>;

constexpr double kStep_s = 1e-4;

double slope(const std::function<double(double)>& value, double t) {
  return (value(t + kStep_s) - value(t - kStep_s)) / (2.0 * kStep_s);
}

// An arm that is a few per cent lighter than its model. It comes up to speed from rest, and swings in seven
// sines of which two lie a tenth of a hertz apart.
Recording swung(const Drive& drive) {
  constexpr double kRate_Hz = 1000.0, kDuration_s = 30.0, kLowest_Hz = 0.1, kSpeedingUp_s = 2.0;
  constexpr double kInertia_kg_m2 = 0.16, kWeight_Nm = 0.5 * 9.81;
  const auto angle = [](double t) {
    double sum = 0.0;
    for (const int k : {1, 2, 3, 5, 7, 9, 11}) {
      sum += 0.55 * std::pow(k, -0.7) * std::sin(2.0 * std::numbers::pi * kLowest_Hz * k * t + 1.3 * k * k);
    }
    const double share = std::min(1.0, t / kSpeedingUp_s);
    return -0.6 + share * share * (3.0 - 2.0 * share) * sum;
  };
  const auto torque = [&](double t) {
    const double ddq = (angle(t + kStep_s) - 2.0 * angle(t) + angle(t - kStep_s)) / (kStep_s * kStep_s);
    return kInertia_kg_m2 * ddq + kWeight_Nm * std::cos(angle(t));
  };
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Recording recording;
  recording.name = "arm.csv";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(kDuration_s * kRate_Hz); ++i) {
    const double t = i / kRate_Hz;
    recording.time_s.push_back(t);
    recording.position_rad[0].push_back(angle(t) + 1e-5 * normal(random));
    recording.torque_Nm[0].push_back(drive(torque, t, slope(angle, t)) + 0.005 * normal(random));
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}

Diagnosis diagnosed(const Drive& drive) {
  const Recording recording = swung(drive);
  DiagnoseOptions options;
  options.bootstrap_replicates = 299;
  return diagnose::diagnose(std::span(&recording, 1), {}, kArm, options);
}

const EffectFinding* found(const Diagnosis& diagnosis, const std::string& kind) {
  const auto effect = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                   [&](const EffectFinding& one) { return one.kind == kind; });
  return effect == diagnosis.effects.end() ? nullptr : &*effect;
}

}  // namespace

TEST_CASE("a drive that is late is found where the lines of its torque cannot be told apart") {
  constexpr double kLag_s = 0.015;
  const Diagnosis diagnosis =
      diagnosed([](const auto& torque, double t, double) { return torque(t) + kLag_s * slope(torque, t); });
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  const EffectFinding* lag = found(diagnosis, "actuator_lag");
  REQUIRE(lag != nullptr);
  CHECK(lag->parameters.front().value == doctest::Approx(kLag_s).epsilon(0.03));
  CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.2 * diagnosis.refitted.heldout_rms_Nm[0]);
}

TEST_CASE("nothing is missing in such a motion where nothing is") {
  CHECK(diagnosed([](const auto& torque, double t, double) { return torque(t); }).verdict ==
        Verdict::kNothingMissing);
}

TEST_CASE("dry and viscous friction are named as such, and not as friction of two directions") {
  const Diagnosis diagnosis = diagnosed([](const auto& torque, double t, double dq) {
    return torque(t) + 0.3 * std::tanh(dq / 0.02) + 0.15 * dq;
  });
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 2);
  const EffectFinding* dry = found(diagnosis, "coulomb_friction");
  const EffectFinding* viscous = found(diagnosis, "viscous_friction");
  REQUIRE(dry != nullptr);
  REQUIRE(viscous != nullptr);
  CHECK(dry->parameters.front().value == doctest::Approx(0.3).epsilon(0.05));
  CHECK(viscous->parameters.front().value == doctest::Approx(0.15).epsilon(0.1));
}
