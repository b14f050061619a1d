// The parts of the comparison between networks and observers that can be known beforehand.
#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "tools/studies/learning/adaptation.hpp"
#include "tools/studies/learning/forecast.hpp"
#include "tools/studies/learning/leg_runs.hpp"
#include "tools/studies/learning/shank_share.hpp"
#include "tools/studies/learning/tables.hpp"

using namespace patella;
using namespace patella::study;

namespace {

Tuned tunedMethod(const std::string& name, std::vector<double> values = {30.0, 30.0, 30.0}) {
  const auto& all = methods();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Method& m) { return m.name == name; });
  REQUIRE(found != all.end());
  REQUIRE(values.size() >= found->tunables.size());
  return {&*found, std::move(values)};
}

Tuned kalman() {
  return tunedMethod("extended Kalman, force, constant rate");
}

double sum(const std::array<double, 2>& errors) {
  return errors[0] + errors[1];
}

}  // namespace

TEST_CASE("a run is its seed's, and the model's error changes what is believed, not what happens") {
  const LegRunOptions right{.seconds = 1.0, .error = {}};
  const Recording first = recordLeg(right, 5);
  const Recording wrong = recordLeg({.seconds = 1.0, .error = {.shank = 0.05}}, 5);
  CHECK(first.samples[700].q == wrong.samples[700].q);
  CHECK(first.samples[700].truth == wrong.samples[700].truth);
  CHECK_FALSE(first.samples[700].q == recordLeg(right, 6).samples[700].q);
  const JointVector straight = JointVector::Zero(2);
  CHECK(wrong.known().mechanism().inertia(straight)(1, 1) ==
        doctest::Approx(1.05 * first.known().mechanism().inertia(straight)(1, 1)));
  const Recording passive = recordLeg({.seconds = 1.0, .error = {}, .passive = true}, 5);
  CHECK(passive.samples[700].truth.norm() == 0.0);
}

TEST_CASE("a wrong shank misleads the observer, and friction that nobody declared") {
  const auto error = [](const ModelError& wrong) {
    const ObservedRun run = observeRun(recordLeg({.seconds = 6.0, .error = wrong}, 3), kalman());
    return sum(meanError(deliverObserver(run, 0.0)));
  };
  const double right = error({});
  CHECK(right < 0.05);
  CHECK(error({.shank = 0.15}) > 2.0 * right);
  CHECK(error({.friction = true}) > 1.5 * right);
}

TEST_CASE("a push is foretold by its rate better than by holding it") {
  const Recording recording = recordLeg({.seconds = 6.0, .error = {}}, 2);
  const ObservedRun run = observeRun(recording, kalman());
  CHECK(sum(meanError(predictConstantRate(recording, run, kalman(), 0.05))) <
        sum(meanError(deliverObserver(run, 0.05))));
  CHECK(knowsRate(kalman(), recording.condition));
  const Tuned momentum = tunedMethod("momentum, 2nd order", {30.0, 30.0, 0.7, 0.7});
  CHECK_FALSE(knowsRate(momentum, recording.condition));
  CHECK_FALSE(knowsRate(tunedMethod("extended Kalman, force, random walk"), recording.condition));
  CHECK_THROWS_AS(predictConstantRate(recording, run, momentum, 0.05), std::invalid_argument);
}

TEST_CASE(
    "without a push, a shank that is 5 % lighter in the model is recovered, and friction that it lacks") {
  // Where nobody pushes and the filter is told so, its noise is the leg's.
  AdaptiveFilter filter = makeAdaptiveFilter(AdaptedBody::kShank, std::array{0.01, 0.01, 0.3});
  const Recording light = recordLeg({.seconds = 5.0, .error = {.shank = -0.05}, .passive = true}, 4);
  const Delivered delivered = deliverAdaptive(filter, light, observeRun(light, kalman()), false, 0.0);
  CHECK(filter.parameters()[0] == doctest::Approx(0.05).epsilon(0.1));
  CHECK(sum(meanError(delivered)) < 0.005);
  const Recording rubbing = recordLeg({.seconds = 5.0, .error = {.friction = true}, .passive = true}, 4);
  deliverAdaptive(filter, rubbing, observeRun(rubbing, kalman()), false, 0.0);
  CHECK(filter.parameters()[1] == doctest::Approx(0.03).epsilon(0.35));
  CHECK(filter.parameters()[3] == doctest::Approx(0.08).epsilon(0.25));  // smoothed wider than the leg's
  CHECK(filter.parameters()[4] == doctest::Approx(0.05).epsilon(0.25));
}

TEST_CASE(
    "a shank that is lighter in the model is found where nobody pushes, and in part where somebody does") {
  for (const bool passive : {true, false}) {
    const Recording light = recordLeg({.seconds = 8.0, .error = {.shank = -0.1}, .passive = passive}, 4);
    const ObservedRun run = observeRun(light, kalman());
    ShankShare share(light.known().mechanism());
    for (const tick::FeatureVector& features : run.observed.features) {
      share.update(features, 1e-3);
    }
    // The model's shank is 0.9 of the true one.
    CHECK(share.share() < 0.13);
    CHECK(share.share() > (passive ? 0.06 : 0.03));
  }
}

TEST_CASE("a table holds every estimator against the first of its condition") {
  const std::vector<LegResult> results = {
      {.condition = "c", .estimator = "observer", .seed = 1, .error_Nm = {0.3, 0.1}, .delay_s = {}},
      {.condition = "c", .estimator = "network", .seed = 1, .error_Nm = {0.1, 0.1}, .delay_s = {}},
      {.condition = "c", .estimator = "observer", .seed = 2, .error_Nm = {0.2, 0.2}, .delay_s = {}},
      {.condition = "c", .estimator = "network", .seed = 2, .error_Nm = {0.1, 0.1}, .delay_s = {}}};
  const std::string text = table(results);
  CHECK(text.find("| observer | 0.2500 ± 0.6353 | 0.1500 ± 0.6353 | 1.00 ± 0.00 (1.00, 1.00) |") !=
        std::string::npos);
  CHECK(text.find("| network | 0.1000 ± 0.0000 | 0.1000 ± 0.0000 | 0.50 ± 0.00 (0.50, 0.50) |") !=
        std::string::npos);
}
