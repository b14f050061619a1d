// Diagnoses of chains: the same as the leg's where a chain is a leg, and effects found where they are.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "core/model/presets.hpp"
#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/model/chains.hpp"
#include "tools/diagnose/checks/convention.hpp"
#include "tools/diagnose/diagnose.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

Diagnosis diagnosed(const Recording& recording, const model::MechanismDescription& mechanism,
                    const std::vector<std::string>& kinds) {
  DiagnoseOptions options;
  options.effects = kinds;
  options.bootstrap_replicates = 299;
  return diagnose::diagnose(std::span(&recording, 1), {}, {.mechanism = mechanism, .effects = {}}, options);
}

/// Joints about axes in turn, as an arm has them.
model::SerialChainParameters arm(int joints) {
  model::SerialChainParameters chain;
  for (int i = 0; i < joints; ++i) {
    model::ChainLink link;
    link.name = "link";
    link.origin_m = {i == 0 ? 0.0 : 0.3, 0.0, 0.0};
    link.turn_rad = {i % 2 == 0 ? std::numbers::pi / 2.0 : -std::numbers::pi / 2.0, 0.0, 0.0};
    link.mass_kg = 3.0 / (i + 1.0);
    link.com_m = {0.15, 0.01, 0.02};
    link.inertia_kg_m2 = {0.004, 0.03, 0.031, 0.0005, 0.0, 0.0};
    chain.links.push_back(link);
  }
  model::ChainLink tip;
  tip.name = "tip";
  tip.joint = model::ChainJoint::kFixed;
  tip.origin_m = {0.25, 0.0, 0.0};
  chain.links.push_back(tip);
  return chain;
}

/// The model's links are a little off.
model::SerialChainParameters wrong(model::SerialChainParameters chain) {
  double sign = 1.0;
  for (model::ChainLink& link : chain.links) {
    link.mass_kg *= 1.0 + 0.04 * sign;
    link.com_m.x() *= 1.0 - 0.03 * sign;
    sign = -sign;
  }
  return chain;
}

std::vector<std::string> labels(const Diagnosis& diagnosis) {
  std::vector<std::string> all;
  for (const EffectFinding& effect : diagnosis.effects) {
    all.push_back(effect.kind + "@" + std::to_string(effect.joint + 1));
  }
  std::sort(all.begin(), all.end());
  return all;
}

const std::vector<std::string> kPlain{"coulomb_friction", "viscous_friction", "linear_stiffness",
                                      "torque_bias", "payload"};

}  // namespace

TEST_CASE("a leg written as a chain has the leg's verdict and effects") {
  const model::PlanarTwoLinkParameters leg = model::adultLeg().parameters;
  model::PlanarTwoLinkParameters off = leg;
  off.mass_kg[0] *= 1.04;
  off.com_m[1] *= 0.97;
  const std::vector<model::EffectDescription> missing{
      {.kind = "coulomb_friction", .joint = 0, .parameters = {3.0, 0.05}},
      {.kind = "linear_stiffness", .joint = 1, .parameters = {9.0, -0.2}}};
  for (const auto& effects : {missing, std::vector<model::EffectDescription>{}}) {
    const Recording recording = moved({.mechanism = leg, .effects = effects}, 20.0, 0.1);
    const Diagnosis as_leg = diagnosed(recording, off, kPlain);
    const Diagnosis as_chain = diagnosed(recording, test::asChain(off), kPlain);
    CHECK(as_leg.verdict == (effects.empty() ? Verdict::kNothingMissing : Verdict::kEffectFound));
    CHECK(as_chain.verdict == as_leg.verdict);
    CHECK(labels(as_chain) == labels(as_leg));
    for (const EffectFinding& effect : as_chain.effects) {
      const auto same = std::find_if(as_leg.effects.begin(), as_leg.effects.end(), [&](const auto& other) {
        return other.kind == effect.kind && other.joint == effect.joint;
      });
      REQUIRE(same != as_leg.effects.end());
      CHECK(effect.parameters.front().value == doctest::Approx(same->parameters.front().value).epsilon(0.03));
    }
  }
}

TEST_CASE("columns of any two joints that were exchanged are named") {
  const model::SerialChainParameters chain = arm(4);
  for (const auto& [first, second] : {std::pair{1UL, 2UL}, {0UL, 3UL}}) {
    Recording recording = moved({.mechanism = chain, .effects = {}}, 20.0, 0.02);
    std::swap(recording.position_rad[first], recording.position_rad[second]);
    std::swap(recording.torque_Nm[first], recording.torque_Nm[second]);
    const std::string said = fmt::format("joints {} and {} are swapped", first + 1, second + 1);
    CHECK_THROWS_WITH_AS(diagnosed(recording, wrong(chain), kPlain), doctest::Contains(said.c_str()),
                         WrongConvention);
  }
}

TEST_CASE("friction of one joint of four is found there and nowhere else") {
  const model::SerialChainParameters chain = arm(4);
  const Recording recording = moved(
      {.mechanism = chain, .effects = {{.kind = "coulomb_friction", .joint = 2, .parameters = {0.6, 0.05}}}},
      20.0, 0.02);
  const Diagnosis diagnosis = diagnosed(recording, wrong(chain), kPlain);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(labels(diagnosis) == std::vector<std::string>{"coulomb_friction@3"});
  const ParameterEstimate& level = diagnosis.effects.front().parameters.front();
  CHECK(level.ci95[0] < 0.6);
  CHECK(level.ci95[1] > 0.6);
  CHECK(level.value == doctest::Approx(0.6).epsilon(0.05));
  // What was found can be read, and has the machine's base parameters within what is said of them.
  const model::BaseParameters truth = model::SerialChain(chain).baseParameters();
  REQUIRE(static_cast<Eigen::Index>(diagnosis.nominal.size()) == truth.size());
  int within = 0;
  for (std::size_t k = 0; k < diagnosis.nominal.size(); ++k) {
    const RefittedParameter& one = diagnosis.nominal[k];
    within += std::abs(one.refitted - truth[static_cast<Eigen::Index>(k)]) < 3.0 * one.sd ? 1 : 0;
  }
  CHECK(within >= static_cast<int>(diagnosis.nominal.size()) - 2);
  CHECK_NOTHROW(model::makeModel(diagnosis.extended));
}

TEST_CASE(
    "a joint without drive that has one base parameter keeps its mass: spring and damping by the motion") {
  model::ChainLink carriage;
  carriage.name = "carriage";
  carriage.joint = model::ChainJoint::kPrismatic;
  carriage.axis = {1.0, 0.0, 0.0};
  carriage.mass_kg = 2.0;
  carriage.inertia_kg_m2 = {0.01, 0.01, 0.01, 0.0, 0.0, 0.0};
  model::SerialChainParameters rail;
  rail.links = {carriage};
  // m ddq + d dq + k q = 0 with d = 0.2 N·s/m and k = 18.005 N/m.
  constexpr double kDecay_1_s = 0.05, kOmega_rad_s = 3.0, kStep_m = 2e-5;
  Recording recording;
  recording.name = "let go";
  recording.rate_Hz = 500.0;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < 10'000; ++i) {
    const double time_s = i / recording.rate_Hz;
    const double q_m = 0.3 * std::exp(-kDecay_1_s * time_s) * std::cos(kOmega_rad_s * time_s);
    recording.time_s.push_back(time_s);
    recording.position_rad[0].push_back(kStep_m * std::round(q_m / kStep_m));
    recording.torque_Nm[0].push_back(0.0);
  }
  recording.segments = {{0, recording.rows()}};
  const Diagnosis diagnosis = diagnosed(recording, rail, kPlain);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(labels(diagnosis) == std::vector<std::string>{"linear_stiffness@1", "viscous_friction@1"});
  for (const EffectFinding& effect : diagnosis.effects) {
    const double truth = effect.kind == "viscous_friction" ? 0.2 : 18.005;
    CHECK(effect.parameters.front().value == doctest::Approx(truth).epsilon(0.02));
  }
}
