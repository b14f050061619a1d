// Serial chains by lot: their bodies, their motion, and what their nominal models can take up.
#include <cmath>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include "core/model/serial_chain.hpp"
#include "tools/bench/diagnose/cases.hpp"
#include "tools/bench/diagnose/draw_chain.hpp"
#include "tools/bench/diagnose/nominal_directions.hpp"

using namespace patella;
using namespace patella::bench;

namespace {

const Surroundings kNobody{};

Body undamped(Body body) {
  body.damping_Nms_rad = {};
  return body;
}

}  // namespace

TEST_CASE("drawn chains and their nominal models are bodies that could be") {
  Random random(5);
  bool slides = false;
  for (std::size_t joints = kFewestJoints; joints <= kMostJoints; ++joints) {
    for (int i = 0; i < 20; ++i) {
      const Body body = drawChain(random, joints, false);
      CHECK(body.joints() == joints);
      CHECK_NOTHROW(model::SerialChain{body.chain});
      CHECK(body.chain.gravity_m_s2.norm() == doctest::Approx(9.81));
      const model::SerialChainParameters wrong = wrongChain(random, body.chain, 0.1);
      CHECK_NOTHROW(model::SerialChain{wrong});
      for (std::size_t j = 0; j < joints; ++j) {
        slides = slides || body.slides(j);
        CHECK(std::abs(wrong.links[j].mass_kg / body.chain.links[j].mass_kg - 1.0) <= 0.1);
        CHECK(wrong.links[j].mass_kg != body.chain.links[j].mass_kg);
      }
    }
  }
  CHECK(slides);
}

TEST_CASE("a chain without friction keeps its energy") {
  Random random(11);
  for (const std::size_t joints : {2U, 4U}) {
    const Body body = undamped(drawChain(random, joints, true));
    Plant plant(body, {}, kNobody, {0.3, -0.4, 0.5, 0.2}, {0.5, -1.0, 0.3, 0.4});
    const double before = plant.energy();
    double worst_J = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      plant.advance({});
      worst_J = std::max(worst_J, std::abs(plant.energy() - before));
    }
    const double weight_J = 9.81 * 0.3 * static_cast<double>(joints);
    CHECK(worst_J < 2e-3 * weight_J);
  }
}

TEST_CASE("a planar chain moves as the leg of the same links") {
  Body leg{.shape = Shape::kLeg,
           .mass_kg = {2.0, 0.85},
           .length_m = {0.2, 0.25},
           .com_m = {0.1, 0.125},
           .inertia_kg_m2 = {0.02, 0.0133},
           .damping_Nms_rad = {0.1, 0.2}};
  Random random(1);
  Body chain = drawChain(random, 2, true);
  for (std::size_t j = 0; j < 2; ++j) {
    model::ChainLink& link = chain.chain.links[j];
    link.mass_kg = leg.mass_kg[j];
    link.com_m = {leg.com_m[j], 0.0, 0.0};
    link.inertia_kg_m2 = {leg.inertia_kg_m2[j], leg.inertia_kg_m2[j], leg.inertia_kg_m2[j], 0.0, 0.0, 0.0};
  }
  chain.chain.links[1].origin_m = {leg.length_m[0], 0.0, 0.0};
  chain.chain.links[2].origin_m = {leg.length_m[1], 0.0, 0.0};
  chain.damping_Nms_rad = leg.damping_Nms_rad;
  const std::array effects{TrueEffect{.kind = Kind::kCoulomb, .joint = 1, .p = {0.2}},
                           TrueEffect{.kind = Kind::kPayload, .joint = 1, .p = {0.4, 0.2}}};
  Plant one(leg, effects, kNobody, {-0.6, -1.0});
  Plant other(chain, effects, kNobody, {-0.6, -1.0});
  for (int tick = 0; tick < 1000; ++tick) {
    one.advance({0.5, -0.3});
    other.advance({0.5, -0.3});
  }
  // Steps of 50 and of 100 µs.
  CHECK(other.position()[0] == doctest::Approx(one.position()[0]).epsilon(1e-4));
  CHECK(other.position()[1] == doctest::Approx(one.position()[1]).epsilon(1e-4));
}

TEST_CASE("what masses and inertias of a chain could be is found from its motion") {
  Random random(2);
  const Body planar = drawChain(random, 3, true);
  const auto taken = [&](Kind kind, std::size_t joint) {
    return inSpan({.kind = kind, .joint = joint, .p = {0.1}}, planar);
  };
  CHECK(taken(Kind::kPayload, 2));
  // An inertia about the first axis turns with nothing else; one about the second turns with the first, too.
  CHECK(taken(Kind::kRotor, 0));
  CHECK_FALSE(taken(Kind::kRotor, 1));
  // An encoder askew on the last joint is a last link askew.
  CHECK(taken(Kind::kOffset, 2));
  CHECK_FALSE(taken(Kind::kOffset, 1));
  CHECK_FALSE(taken(Kind::kBias, 1));
  CHECK_FALSE(taken(Kind::kGain, 1));
  CHECK_FALSE(taken(Kind::kCoulomb, 1));
}

TEST_CASE("where nothing is missing, the chain explains the run to a fiftieth of its noise") {
  for (const std::size_t joints : {3U, 6U}) {
    const Case drawn =
        drawCase(3, Suite::kNone, {.effect = {}, .mechanism = "chain", .motion = {}, .joints = joints});
    CHECK(drawn.rig.body.joints() == joints);
    CHECK(drawn.run.recording.joints == static_cast<int>(joints));
    CHECK(analyse(drawn.rig, drawn.run).raw_strength < 0.02);
    CHECK(isSensible(loadOf(drawn.rig), drawn.rig.body));
  }
}

TEST_CASE("an effect on a chain has the strength that was asked for") {
  const Case drawn = drawCase(
      4, Suite::kSingle,
      {.effect = "coulomb_friction", .mechanism = "chain", .motion = {}, .joints = 3, .strength = 2.0});
  CHECK(analyse(drawn.rig, drawn.run).strength == doctest::Approx(2.0).epsilon(0.02));
  CHECK_THROWS_WITH_AS(
      drawCase(1, Suite::kSingle,
               {.effect = "passive_knee_moment", .mechanism = "chain", .motion = {}, .joints = 2}),
      doctest::Contains("passive_knee_moment"), std::invalid_argument);
}
