// A base at an angle to gravity that its model does not have, and a torque column that is dead.
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tools/diagnose/checks/convention_search.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/fit/base_gravity.hpp"

namespace patella::diagnose {
namespace {

using model::ModelDescription;

ModelDescription arm() {
  return uprightChain(3);
}

ModelDescription mounted(double angle_rad) {
  return withBaseGravity(arm(), {9.81 * std::sin(angle_rad), 0.0, -9.81 * std::cos(angle_rad)});
}

}  // namespace

TEST_CASE("a robot on a slope, a wall or a ceiling is told from wrong columns") {
  for (const double angle_deg : {35.0, 90.0, 180.0}) {
    CAPTURE(angle_deg);
    const Recording recording = moved(mounted(angle_deg * std::numbers::pi / 180.0), 20.0, 0.02);
    try {
      requireConventions(recording, arm());
      FAIL("was believed");
    } catch (const WrongConvention& wrong) {
      const std::string what = wrong.what();
      CAPTURE(what);
      CHECK(wrong.conventions().front().kind == ConventionKind::kMounting);
      CHECK(what.find(fmt::format("stands {:.0f}° off", angle_deg)) != std::string::npos);
      CHECK_NOTHROW(requireConventions(recording, mounted(angle_deg * std::numbers::pi / 180.0)));
    }
  }
}

TEST_CASE("a sign that is wrong is no other base") {
  Recording recording = moved(arm(), 20.0, 0.02);
  for (double& torque_Nm : recording.torque_Nm[1]) {
    torque_Nm = -torque_Nm;
  }
  try {
    requireConventions(recording, arm());
    FAIL("was believed");
  } catch (const WrongConvention& wrong) {
    for (const Convention& convention : wrong.conventions()) {
      CHECK(convention.kind == ConventionKind::kTorqueSign);
    }
  }
}

TEST_CASE("a torque column that is dead under a load is suspected, whatever stands for it") {
  Recording recording = moved(arm(), 30.0, 0.02);
  // The noise of its sensor is left.
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (double& torque_Nm : recording.torque_Nm[1]) {
    torque_Nm = noise(random);
  }
  const Diagnosis diagnosis = diagnose(std::span(&recording, 1), {}, arm(), {});
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CAPTURE(diagnosis.explanation);
  CHECK(diagnosis.explanation.find("The torque of joint 2 is next to nothing") != std::string::npos);
}

}  // namespace patella::diagnose
