#include "firmware_app/files/model_file.hpp"

#include <cmath>
#include <span>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/model/presets.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/wording.hpp"
#include "tests/support/joint_pair.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/model/chains.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::app;
using patella::model::EffectDescription;
using patella::model::MechanismDescription;
using patella::model::ModelDescription;
using patella::test::messageOf;
using patella::test::pair;
using patella::test::ScratchFolder;

namespace {

constexpr const char* kLeg = R"([mechanism]
kind = "planar_two_link"
mass_kg = [2, 0.85]
length_m = [0.2, 0.25]
com_m = [0.1, 0.125]
inertia_kg_m2 = [0.02, 0.01]
)";

std::string errorOf(const std::string& text) {
  return messageOf<FileError>([&] { parseModel(text, "model.toml"); });
}

std::string errorOfEffect(const std::string& lines) {
  return errorOf(kLeg + std::string("[[effect]]\n") + lines);
}

}  // namespace

TEST_CASE("a model of a file moves as the same model made by hand") {
  const ModelDescription description = parseModel(kLeg + std::string(R"(
[[effect]]
kind = "viscous_friction"
joint = 2
coefficient_Nms_rad = 0.3
)"),
                                                  "model.toml");
  CHECK(description.joints() == 2);
  const model::DynamicsModel dynamics = makeModel(description);
  const model::PlanarTwoLink leg(
      {.mass_kg = {2, 0.85}, .length_m = {0.2, 0.25}, .com_m = {0.1, 0.125}, .inertia_kg_m2 = {0.02, 0.01}});
  model::EffectInput input;
  input.q = pair(-1.2, 0.4);
  input.dq = pair(0.5, -2.0);
  input.torque_Nm = pair(0.0, 0.0);
  const JointVector ddq = pair(1.0, -3.0);
  const JointVector expected = leg.inertia(input.q) * ddq + leg.coriolis(input.q, input.dq) * input.dq +
                               leg.gravity(input.q) + pair(0.0, 0.3 * -2.0);
  CHECK((dynamics.inverseDynamics(input, ddq) - expected).norm() < 1e-12);
}

TEST_CASE("the shipped models are the presets") {
  const auto check = [](const std::string& name, const model::LegPreset& preset) {
    CAPTURE(name);
    // The files round what the presets compute.
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); };
    const model::DynamicsModel file =
        makeModel(loadModel(checkout::source() / "firmware_app/config/models" / (name + ".toml")));
    const auto& leg = dynamic_cast<const model::PlanarTwoLink&>(file.mechanism()).parameters();
    for (const std::size_t link : {0U, 1U}) {
      CHECK(same(leg.mass_kg[link], preset.parameters.mass_kg[link]));
      CHECK(same(leg.length_m[link], preset.parameters.length_m[link]));
      CHECK(same(leg.com_m[link], preset.parameters.com_m[link]));
      CHECK(same(leg.inertia_kg_m2[link], preset.parameters.inertia_kg_m2[link]));
    }
    CHECK(leg.gravity_m_s2 == preset.parameters.gravity_m_s2);
    REQUIRE(file.effects().size() == 2);
    for (const std::size_t joint : {0U, 1U}) {
      CHECK(file.effects()[joint]->descriptor().kind == "viscous_friction");
      CHECK(file.effects()[joint]->joint() == static_cast<int>(joint));
      CHECK(file.effects()[joint]->parameters()[0] == preset.viscous_Nms_rad);
    }
  };
  check("paper", model::paperLeg());
  check("physical", model::physicalLeg());
  check("adult", model::adultLeg());
}

TEST_CASE("two links by base parameters move as those that have them") {
  const auto close = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); };
  for (const std::string name :
       {"firmware_app/config/models/adult.toml", "firmware_app/config/models/paper.toml",
        "tools/diagnose/maps/acromonk_model.toml", "tools/diagnose/maps/double_pendulum_c0_model.toml",
        "tools/diagnose/maps/free_double_pendulum_model.toml"}) {
    CAPTURE(name);
    const model::DynamicsModel whole = makeModel(loadModel(checkout::source() / name));
    const auto& leg = dynamic_cast<const model::PlanarTwoLink&>(whole.mechanism());
    const model::BaseParameters base = leg.baseParameters();
    const auto& length = leg.parameters().length_m;
    const ModelDescription described =
        parseModel("[mechanism]\nkind = \"planar_two_link\"\nlength_m = [" + formatNumber(length[0]) + ", " +
                       formatNumber(length[1]) + "]\nbase_parameters = { thigh_inertia_kg_m2 = " +
                       formatNumber(base[0]) + ", shank_inertia_kg_m2 = " + formatNumber(base[1]) +
                       ", thigh_moment_kg_m = " + formatNumber(base[3]) +
                       ", shank_moment_kg_m = " + formatNumber(base[4]) + " }\n",
                   "model.toml");
    const auto& links = std::get<model::PlanarTwoLinkParameters>(described.mechanism);
    const model::BaseParameters found = model::PlanarTwoLink(links).baseParameters();
    for (Eigen::Index i = 0; i < base.size(); ++i) {
      CAPTURE(i);
      CHECK(close(found[i], base[i]));
    }
    for (const std::size_t link : {0U, 1U}) {
      CHECK(links.mass_kg[link] > 0.0);
      CHECK(links.inertia_kg_m2[link] >= 0.0);
      CHECK(links.com_m[link] >= 0.0);
    }
    CHECK(close(links.length_m[0], length[0]));
  }
}

TEST_CASE("base parameters that no two links have are refused") {
  const auto with = [](const std::string& thigh_inertia, const std::string& shank_moment,
                       const std::string& more = "") {
    return errorOf("[mechanism]\nkind = \"planar_two_link\"\nlength_m = [0.5, 0.4]\n" + more +
                   "base_parameters = { thigh_inertia_kg_m2 = " + thigh_inertia +
                   ", shank_inertia_kg_m2 = 0.5, thigh_moment_kg_m = 2, shank_moment_kg_m = " + shank_moment +
                   " }\n");
  };
  CHECK(with("2", "1") == "(nothing was thrown)");
  CHECK(with("2", "2") ==
        "model.toml:4: key 'mechanism.base_parameters': fit no two links: the shank's mass would be at least "
        "shank_moment_kg_m² / shank_inertia_kg_m2 = 8 kg and at most thigh_moment_kg_m / length_m[1] = 4 kg, "
        "expected the thigh's to include m2 l1 and m2 l1²");
  CHECK(with("0.25", "1") ==
        "model.toml:4: key 'mechanism.base_parameters': fit no two links: the shank's mass would be at least "
        "shank_moment_kg_m² / shank_inertia_kg_m2 = 2 kg and at most thigh_inertia_kg_m2 / length_m[1]² = 1 "
        "kg, "
        "expected the thigh's to include m2 l1 and m2 l1²");
  CHECK(with("-1", "1").starts_with(
      "model.toml:4: key 'mechanism.base_parameters.thigh_inertia_kg_m2': value -1, expected a number in"));
  CHECK(with("420", "1") ==
        "model.toml:4: key 'mechanism.base_parameters': mechanism.inertia_kg_m2 (planar_two_link)[1] = "
        "419.125, "
        "expected 0 to 20");
  CHECK(with("2", "1", "mass_kg = [1, 1]\n") ==
        "model.toml:4: key 'mechanism.mass_kg': stands beside 'base_parameters', which tell it; expected one "
        "of "
        "the two");
}

TEST_CASE("every mechanism and every effect survives writing and reading") {
  const ScratchFolder folder;
  test::RandomChains random(9);
  model::ChainGroupParameters group{{random.draw(2), random.draw(3)}};
  group.chains[1].gravity_m_s2 = group.chains[0].gravity_m_s2;
  const MechanismDescription mechanisms[] = {
      model::adultLeg().parameters,
      model::RevoluteJointParameters{.inertia_kg_m2 = 0.1, .moment_kg_m = 1.0 / 3.0, .length_m = 0.4},
      model::PrismaticJointParameters{.mass_kg = 95.1089, .inclination_rad = 0.1, .gravity_m_s2 = 0.0},
      test::RandomChains(8).draw(5), group};
  for (const MechanismDescription& mechanism : mechanisms) {
    ModelDescription description{.mechanism = mechanism, .effects = {}};
    for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
      EffectDescription effect{
          .kind = std::string(descriptor->kind), .joint = description.joints() - 1, .parameters = {}};
      for (const model::EffectParameter& parameter : descriptor->parameters) {
        effect.parameters.push_back(parameter.initial);
      }
      try {
        model::makeModel({.mechanism = mechanism, .effects = {effect}});
      } catch (const std::invalid_argument&) {
        continue;  // not every effect fits every mechanism
      }
      description.effects.push_back(effect);
    }
    REQUIRE(description.effects.size() >= 5);
    saveModel(description, folder / "model.toml", "First line\nsecond line");
    const std::string text = readFile(folder / "model.toml");
    CHECK(text.starts_with("# First line\n# second line\n[mechanism]\n"));
    const ModelDescription reread = loadModel(folder / "model.toml");
    CHECK(reread.effects.size() == description.effects.size());
    CHECK(modelText(reread) == modelText(description));
    CHECK(modelText(describeModel(makeModel(reread))) == modelText(description));
  }
}

TEST_CASE("malformed models are refused with file, line, key, value and expectation") {
  CHECK(errorOf("") == "model.toml:1: key 'mechanism' is missing, expected a table");
  CHECK(
      errorOf("[mechanism]\nkind = \"planar_2r\"") ==
      "model.toml:2: key 'mechanism.kind': value 'planar_2r', expected one of 'planar_two_link', 'revolute', "
      "'prismatic', 'serial_chain'");
  CHECK(errorOf("[mechanism]\nkind = \"revolute\"\ninertia_kg_m2 = -0.1") ==
        "model.toml:3: key 'mechanism.inertia_kg_m2': value -0.1, expected a number in [1e-05, 20]");
  CHECK(errorOf("[mechanism]\nkind = \"prismatic\"\nmass = 95") ==
        "model.toml:1: key 'mechanism.mass_kg' is missing, expected a number in [0.001, 1000]; there is "
        "'mass' in its place");
  CHECK(errorOf("[mechanism]\nkind = \"planar_two_link\"\nmass_kg = [2, nan]") ==
        "model.toml:3: key 'mechanism.mass_kg': value nan, expected an array of 2 finite numbers, each in "
        "[0.001, 50]");
  CHECK(errorOf(kLeg + std::string("gravity = 9.81")) ==
        "model.toml:7: key 'mechanism.gravity' is unknown, did you mean 'gravity_m_s2'?");
  CHECK(errorOfEffect("kind = \"viscous_friction\"\njoint = 3\ncoefficient_Nms_rad = 1") ==
        "model.toml:9: key 'effect[1].joint': value 3, expected an integer in [1, 2]");
  CHECK(errorOfEffect("kind = \"viscous_friction\"\njoint = 0\ncoefficient_Nms_rad = 1") ==
        "model.toml:9: key 'effect[1].joint': value 0, expected an integer in [1, 2]");
  CHECK(errorOfEffect("kind = \"viscous_friction\"\njoint = 1\ncoefficient_Nms_rad = -1") ==
        "model.toml:10: key 'effect[1].coefficient_Nms_rad': value -1, expected a number in [0, 1000]");
  CHECK(errorOfEffect("kind = \"viscous_friction\"\njoint = 1\ncoefficient = 1") ==
        "model.toml:7: key 'effect[1].coefficient_Nms_rad' is missing, expected a number in [0, 1000]; there "
        "is "
        "'coefficient' in its place");
  CHECK(errorOfEffect("kind = \"viscous_friction\"\njoint = 1\ncoefficient_Nms_rad = 1\ngap_rad = 1") ==
        "model.toml:11: key 'effect[1].gap_rad' is unknown");
  const std::string unknown = errorOfEffect("kind = \"stiction\"\njoint = 1");
  CHECK(unknown.starts_with("model.toml:8: key 'effect[1].kind': value 'stiction', expected one of "));
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    CHECK(unknown.find("'" + std::string(descriptor->kind) + "'") != std::string::npos);
  }
}

TEST_CASE("a model that cannot be is not written, and the file stays as it was") {
  const ScratchFolder folder;
  const auto path = folder / "model.toml";
  ModelDescription description = parseModel(kLeg, "model.toml");
  saveModel(description, path);
  const std::string before = readFile(path);
  description.effects.push_back({.kind = "viscous_friction", .joint = 0, .parameters = {-1.0}});
  CHECK_THROWS_AS(saveModel(description, path), std::invalid_argument);
  CHECK(readFile(path) == before);
  CHECK(folder.entries() == 1);
}
