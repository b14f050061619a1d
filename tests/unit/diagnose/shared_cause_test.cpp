// One cause on several joints: it is found though the joints leave much the same, or named where the library
// has none.
#include "tools/diagnose/verdict/shared_cause.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/diagnose/swinging_arm.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/verdict/cause_hint.hpp"
#include "tools/diagnose/verdict/findings.hpp"

namespace patella::diagnose {
namespace {

using model::ModelDescription;

ModelDescription upright() {
  return uprightChain(4);
}

Diagnosis diagnosed(const Recording& recording, const ModelDescription& model) {
  return diagnose(std::span(&recording, 1), {}, model, {});
}

bool says(const Diagnosis& diagnosis, const std::string& words) {
  INFO(diagnosis.explanation);
  return diagnosis.explanation.find(words) != std::string::npos;
}

/// The number behind some words of the answer.
double numberBehind(const Diagnosis& diagnosis, const std::string& words) {
  INFO(diagnosis.explanation);
  const std::size_t found = diagnosis.explanation.find(words);
  REQUIRE(found != std::string::npos);
  return std::stod(diagnosis.explanation.substr(found + words.size()));
}

std::string hintAt(const Recording& recording, const ModelDescription& model) {
  const Dataset data(std::span(&recording, 1), {});
  ModelFitter fitter(data, model, {});
  return causeHint(data, model, fitter.nominal());
}

constexpr std::array kLevel_Nm{0.6, 0.8, 0.4, 0.2};

/// The same with dry friction on every joint.
ModelDescription rubbing() {
  ModelDescription model = upright();
  for (int joint = 0; joint < 4; ++joint) {
    model.effects.push_back({.kind = "coulomb_friction",
                             .joint = joint,
                             .parameters = {kLevel_Nm[static_cast<std::size_t>(joint)], 0.02}});
  }
  return model;
}

Recording lateByTwoSamples(Recording recording) {
  for (int joint = 0; joint < recording.joints; ++joint) {
    auto& torque_Nm = recording.torque_Nm[static_cast<std::size_t>(joint)];
    torque_Nm.insert(torque_Nm.begin(), 2, torque_Nm.front());
    torque_Nm.resize(recording.rows());
  }
  return recording;
}

TEST_CASE("a base that is tilted is named with its angle") {
  ModelDescription truth = upright();
  const double angle_rad = 8.0 * kPi / 180.0;
  std::get<model::SerialChainParameters>(truth.mechanism).gravity_m_s2 = {9.81 * std::sin(angle_rad), 0.0,
                                                                          -9.81 * std::cos(angle_rad)};
  const Diagnosis diagnosis = diagnosed(moved(truth, 30.0, 0.02), upright());
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CHECK(diagnosis.effects.empty());
  CHECK(numberBehind(diagnosis, "The base stands ") == doctest::Approx(8.0).epsilon(0.03));
  CHECK(says(diagnosis, "is no more than noise"));
  CHECK(diagnosed(moved(upright(), 30.0, 0.02), upright()).verdict == Verdict::kNothingMissing);
}

TEST_CASE("torques that are all in another scale are told, and not that nothing is missing") {
  Recording recording = swinging(Arm{});
  for (auto& torque_Nm : recording.torque_Nm) {
    for (double& value : torque_Nm) {
      value *= 0.5;
    }
  }
  const Diagnosis diagnosis = diagnosed(recording, arm());
  CHECK(diagnosis.verdict != Verdict::kNothingMissing);
  CHECK(hintAt(recording, arm()).find("All torques are 0.5") != std::string::npos);
  CHECK(hintAt(swinging(Arm{}), arm()).empty());
}

TEST_CASE("friction of every joint is named beside torque columns that come late, and beside a tilted base") {
  ModelDescription truth = rubbing();
  const Recording late = lateByTwoSamples(moved(truth, 30.0, 0.02));
  const double angle_rad = 4.0 * kPi / 180.0;
  std::get<model::SerialChainParameters>(truth.mechanism).gravity_m_s2 = {0.0, 9.81 * std::sin(angle_rad),
                                                                          -9.81 * std::cos(angle_rad)};
  for (const auto& [recording, words, size] :
       {std::tuple{late, "All torque columns come ", 10.0},
        std::tuple{moved(truth, 30.0, 0.02), "The base stands ", 4.0}}) {
    const Diagnosis diagnosis = diagnosed(recording, upright());
    CHECK(numberBehind(diagnosis, words) == doctest::Approx(size).epsilon(0.03));
    CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
    REQUIRE(diagnosis.effects.size() == kLevel_Nm.size());
    for (const EffectFinding& effect : diagnosis.effects) {
      CHECK(effect.kind == "coulomb_friction");
      CHECK(effect.asserted());
      CHECK(effect.parameters[0].value ==
            doctest::Approx(kLevel_Nm[static_cast<std::size_t>(effect.joint)]).epsilon(0.03));
    }
  }
}

TEST_CASE("a tilted base and late torque columns are both named, each once") {
  ModelDescription truth = upright();
  truth.effects.push_back({.kind = "coulomb_friction", .joint = 1, .parameters = {0.8, 0.02}});
  const double angle_rad = 4.0 * kPi / 180.0;
  std::get<model::SerialChainParameters>(truth.mechanism).gravity_m_s2 = {0.0, 9.81 * std::sin(angle_rad),
                                                                          -9.81 * std::cos(angle_rad)};
  const Diagnosis diagnosis = diagnosed(lateByTwoSamples(moved(truth, 30.0, 0.02)), upright());
  CHECK(numberBehind(diagnosis, "All torque columns come ") == doctest::Approx(10.0).epsilon(0.05));
  CHECK(numberBehind(diagnosis, "The base stands ") == doctest::Approx(4.0).epsilon(0.05));
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.effects.front().kind == "coulomb_friction");
  CHECK(diagnosis.effects.front().asserted());
  CHECK(diagnosis.effects.front().parameters[0].value == doctest::Approx(0.8).epsilon(0.03));
}

TEST_CASE("torques that come late by less than half a sample were read so") {
  Recording recording = moved(rubbing(), 30.0, 0.005);
  for (int joint = 0; joint < recording.joints; ++joint) {
    auto& torque_Nm = recording.torque_Nm[static_cast<std::size_t>(joint)];
    for (std::size_t i = torque_Nm.size(); i-- > 1;) {
      torque_Nm[i] += 0.4 * (torque_Nm[i - 1] - torque_Nm[i]);
    }
  }
  const Diagnosis diagnosis = diagnosed(recording, upright());
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == kLevel_Nm.size());
  const auto& warnings = diagnosis.warnings;
  CHECK(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("All torque columns come 2") != std::string::npos &&
           warning.find("less than half a sample") != std::string::npos;
  }));
}

TEST_CASE("what a filter does beyond a delay asserts no effect") {
  Recording recording = moved(rubbing(), 30.0, 0.02);
  const double share = 1.0 - std::exp(-2.0 * kPi * 15.0 / recording.rate_Hz);
  for (int joint = 0; joint < recording.joints; ++joint) {
    auto& torque_Nm = recording.torque_Nm[static_cast<std::size_t>(joint)];
    for (std::size_t i = 1; i < torque_Nm.size(); ++i) {
      torque_Nm[i] = torque_Nm[i - 1] + share * (torque_Nm[i] - torque_Nm[i - 1]);
    }
  }
  const Diagnosis diagnosis = diagnosed(recording, upright());
  CHECK(says(diagnosis, "All torque columns come"));
  CHECK(diagnosis.effects.size() > kLevel_Nm.size());
  for (const EffectFinding& effect : diagnosis.effects) {
    CAPTURE(effect.kind);
    CHECK(effect.asserted() == (effect.kind == "coulomb_friction"));
  }
}

TEST_CASE("what an effect explains as well is no shared cause") {
  ModelDescription loaded = upright();
  loaded.effects.push_back({.kind = "payload", .joint = 2, .parameters = {0.8, 0.15}});
  const Diagnosis diagnosis = diagnosed(moved(loaded, 30.0, 0.02), upright());
  CHECK_FALSE(says(diagnosis, "base"));
  CHECK_FALSE(says(diagnosis, "columns"));
}

TEST_CASE("a band between two joints is told with both") {
  Recording recording = moved(upright(), 30.0, 0.02);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double band_Nm = 6.0 * (recording.position_rad[1][i] - recording.position_rad[3][i]);
    recording.torque_Nm[1][i] += band_Nm;
    recording.torque_Nm[3][i] -= band_Nm;
  }
  CHECK(hintAt(recording, upright()).find("q2 and q4") != std::string::npos);
}

TEST_CASE("friction of joints that move alike is found on both") {
  Recording recording = swinging(Arm{});
  const model::DynamicsModel dynamics = model::makeModel(arm());
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    model::EffectInput state{
        .q = JointVector::Zero(2), .dq = JointVector::Zero(2), .torque_Nm = JointVector::Zero(2)};
    JointVector ddq = JointVector::Zero(2);
    for (const auto& [size, frequency_Hz] : {std::pair{0.6, 0.31}, std::pair{0.25, 0.83}}) {
      const double w = 2.0 * kPi * frequency_Hz;
      state.q.array() += size * std::sin(w * recording.time_s[i]);
      state.dq.array() += size * w * std::cos(w * recording.time_s[i]);
      ddq.array() -= size * w * w * std::sin(w * recording.time_s[i]);
    }
    const JointVector torque_Nm = dynamics.inverseDynamics(state, ddq);
    for (int joint = 0; joint < 2; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      recording.position_rad[j][i] = state.q[joint];
      recording.torque_Nm[j][i] = torque_Nm[joint] + 0.3 * std::tanh(state.dq[joint] / 0.005) + noise(random);
    }
  }
  const Diagnosis diagnosis = diagnosed(recording, arm());
  INFO(diagnosis.explanation);
  REQUIRE(diagnosis.verdict == Verdict::kEffectFound);
  for (int joint = 0; joint < 2; ++joint) {
    const auto found =
        std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(), [joint](const auto& effect) {
          return effect.kind == "coulomb_friction" && effect.joint == joint && effect.asserted();
        });
    REQUIRE(found != diagnosis.effects.end());
    CHECK(found->parameters[0].value == doctest::Approx(0.3).epsilon(0.05));
  }
}

TEST_CASE("a gain's error is that of the gain, whatever was predicted without it") {
  Recording recording = swinging(Arm{});
  ModelDescription gained = arm();
  gained.effects.push_back({.kind = "torque_gain", .joint = 1, .parameters = {0.2}});
  for (double& value : recording.torque_Nm[1]) {
    value /= 1.2;
  }
  const auto errorOf = [](const Recording& of, const ModelDescription& model) {
    return residualOf(Dataset(std::span(&of, 1), {}), model).rms[1];
  };
  CHECK(errorOf(recording, gained) == doctest::Approx(errorOf(swinging(Arm{}), arm()) / 1.2));
}

}  // namespace
}  // namespace patella::diagnose
