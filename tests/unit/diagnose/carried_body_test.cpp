// A body at the end of a chain that its model lacks.
#include "tools/diagnose/verdict/carried_body.hpp"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {
namespace {

using model::ModelDescription;

const PointBody kBody{.mass_kg = 1.2, .at_m = {0.2, 0.05, -0.04}};

ModelDescription arm(double masses = 1.0) {
  return uprightChain(3, masses);
}

Diagnosis diagnosed(const ModelDescription& truth) {
  const Recording recording = moved(truth, 30.0, 0.02);
  return diagnose(std::span(&recording, 1), {}, arm(), {});
}

const EffectFinding* foundIn(const Diagnosis& diagnosis, const std::string& kind) {
  const auto found = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                  [&](const EffectFinding& effect) { return effect.kind == kind; });
  return found == diagnosis.effects.end() ? nullptr : &*found;
}

void checkBody(const Diagnosis& diagnosis) {
  CAPTURE(diagnosis.explanation);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  const EffectFinding* body = foundIn(diagnosis, "payload");
  REQUIRE(body != nullptr);
  CHECK(body->asserted());
  CHECK(body->joint == 2);
  const double values[] = {kBody.mass_kg, kBody.at_m.norm()};
  for (std::size_t i = 0; i < 2; ++i) {
    const ParameterEstimate& estimate = body->parameters[i];
    CAPTURE(estimate.name);
    CHECK(estimate.value == doctest::Approx(values[i]).epsilon(0.1));
    CHECK(estimate.ci95[0] < values[i]);
    CHECK(estimate.ci95[1] > values[i]);
  }
}

}  // namespace

TEST_CASE("a payload beside the axis of the last link is found with its mass and place") {
  const Diagnosis diagnosis = diagnosed(withBody(arm(), kBody));
  checkBody(diagnosis);
  CHECK(diagnosis.effects.size() == 1);
  // The loop's model carries it.
  const auto& chain = std::get<model::SerialChainParameters>(diagnosis.extended.mechanism);
  CHECK(chain.links.back().mass_kg == doctest::Approx(2.2).epsilon(0.1));
  CHECK(diagnosis.after.heldout_rms_Nm[2] < 0.05 * diagnosis.before.heldout_rms_Nm[2]);
}

TEST_CASE("friction is found beside a payload") {
  ModelDescription truth = withBody(arm(), kBody);
  truth.effects.push_back({.kind = "coulomb_friction", .joint = 1, .parameters = {0.8, 0.02}});
  const Diagnosis diagnosis = diagnosed(truth);
  checkBody(diagnosis);
  const EffectFinding* friction = foundIn(diagnosis, "coulomb_friction");
  REQUIRE(friction != nullptr);
  CHECK(friction->parameters.front().value == doctest::Approx(0.8).epsilon(0.03));
}

TEST_CASE("masses that are a little off are no payload") {
  for (const double masses : {1.0, 1.05, 0.95}) {
    CAPTURE(masses);
    const Diagnosis diagnosis = diagnosed(arm(masses));
    CHECK(diagnosis.verdict == Verdict::kNothingMissing);
    CHECK(diagnosis.effects.empty());
  }
}

TEST_CASE("a body joins the last link as a point does") {
  const ModelDescription model = withBody(arm(), kBody);
  const auto& link = std::get<model::SerialChainParameters>(model.mechanism).links.back();
  CHECK(link.mass_kg == doctest::Approx(2.2));
  CHECK(link.com_m.x() == doctest::Approx((1.0 * 0.15 + 1.2 * 0.2) / 2.2));
  // Two points, reduced to the one between them.
  const double reduced_kg = 1.0 * 1.2 / 2.2;
  const Eigen::Vector3d apart = kBody.at_m - Eigen::Vector3d(0.15, 0.01, 0.02);
  CHECK(link.inertia_kg_m2[0] ==
        doctest::Approx(0.004 + reduced_kg * (apart.y() * apart.y() + apart.z() * apart.z())));
  CHECK(link.inertia_kg_m2[3] == doctest::Approx(0.0005 - reduced_kg * apart.x() * apart.y()));
}

}  // namespace patella::diagnose
