// Numbers that a reader is told to look at twice.
#include "tools/diagnose/verdict/runaways.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

std::vector<Runaway> of(const Diagnosis& diagnosis, const model::ModelDescription& given = {}) {
  return runawaysOf(diagnosis, given, FitOptions{});
}

/// A diagnosis that found friction with this estimate of its level.
Diagnosis withLevel(const ParameterEstimate& level) {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.effects = {diagnosis.effects[1]};
  diagnosis.effects[0].parameters = {level};
  return diagnosis;
}

/// The made-up diagnosis, of a model that declared this.
std::vector<Runaway> declaring(const model::EffectDescription& effect) {
  const Diagnosis diagnosis = test::madeUpDiagnosis();
  return of(diagnosis, {.mechanism = diagnosis.extended.mechanism, .effects = {effect}});
}

}  // namespace

TEST_CASE("a diagnosis whose numbers are sound has nothing to look at twice") {
  CHECK(of(test::madeUpDiagnosis()).empty());
}

TEST_CASE("an interval that holds zero, or the whole range, and a value at its bound") {
  const auto zero = of(withLevel({.name = "level_Nm", .value = 0.1, .ci95 = {-0.02, 0.22}}));
  REQUIRE(zero.size() == 1);
  CHECK(zero[0].what == "coulomb_friction@2 level_Nm");
  CHECK(zero[0].words == "coulomb friction on joint 2: level 0.10 [-0.02, 0.22] N·m may be zero");
  CHECK(zero[0].refitted == 0.1);
  CHECK(zero[0].limit == 0.0);
  CHECK(std::isnan(zero[0].nominal));

  const auto anything = of(withLevel({.name = "level_Nm", .value = 90.0, .ci95 = {-10.0, 210.0}}));
  REQUIRE(anything.size() == 1);
  CHECK(anything[0].words ==
        "coulomb friction on joint 2: level may be anything: the interval holds its whole range, 0 N·m to "
        "200 N·m");

  const auto largest = of(withLevel({.name = "level_Nm", .value = 200.0, .ci95 = {190.0, 210.0}}));
  REQUIRE(largest.size() == 1);
  CHECK(largest[0].limit == 200.0);
  CHECK(largest[0].words == "coulomb friction on joint 2: level stands at 200 N·m, the end of its range");

  const auto searched =
      of(withLevel({.name = "level_Nm", .value = 30.0, .ci95 = {20.0, 40.0}, .at_bound = true}));
  REQUIRE(searched.size() == 1);
  CHECK(searched[0].words == "coulomb friction on joint 2: level stands at 30 N·m, where the search ends");
}

TEST_CASE("zero is a place like any other for what may be negative and is no strength") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.effects[0].parameters[1].ci95 = {-0.5, 0.1};  // a spring's rest position
  CHECK(of(diagnosis).empty());
}

TEST_CASE("an error above the torque is said in words, of the model as given and of what was found") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.before.train_relative[1] = 1.4;
  diagnosis.before.heldout_relative[1] = 1.3;
  diagnosis.after.heldout_relative[0] = 1.25;
  const auto found = of(diagnosis);
  REQUIRE(found.size() == 2);
  CHECK(found[0].what == "error@2");
  CHECK(found[0].refitted == 2.31);
  CHECK(found[0].nominal == doctest::Approx(2.31 / 1.4));
  CHECK(found[0].limit == 1.0);
  CHECK(found[0].words ==
        "the error of joint 2, of the model as given, is larger than its torque (140 %): no model at all "
        "would do "
        "better");
  CHECK(found[1].words ==
        "the error of joint 1, with what was found, on held-out data, is larger than its torque (125 %): no "
        "model at "
        "all would do better");
}

TEST_CASE("drives that rest have no torque to compare an error with") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.before.train_relative[1] = 1e9;
  CHECK(of(diagnosis).empty());
}

TEST_CASE("a model that was left as it was is named once") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.before.train_relative[1] = 1.4;
  diagnosis.after = diagnosis.before;
  CHECK(of(diagnosis).size() == 1);
}

TEST_CASE("a mechanism's parameter outside its tolerance is named with both values") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  const double widest = std::exp(0.2);
  diagnosis.nominal = {{.name = "com_m[2]",
                        .nominal = 0.2,
                        .refitted = 0.24,
                        .sd = 0.01,
                        .tolerated = {0.2 / widest, 0.2 * widest}},
                       {.name = "mass_kg[2]",
                        .nominal = 4.0,
                        .refitted = 5.0,
                        .sd = 0.1,
                        .tolerated = {4.0 / widest, 4.0 * widest}}};
  const auto found = of(diagnosis);
  REQUIRE(found.size() == 1);
  CHECK(found[0].what == "mass_kg[2]");
  CHECK(found[0].nominal == 4.0);
  CHECK(found[0].refitted == 5.0);
  CHECK(found[0].limit == doctest::Approx(0.2));
  CHECK(found[0].words ==
        "the model's mass [2] went from 4 to 5 kg (+25 %), outside its tolerance of -18 to +22 %");
}

TEST_CASE("a declared effect that changed is named with both values, one that kept its value is not") {
  CHECK(declaring({.kind = "coulomb_friction", .joint = 1, .parameters = {1.5, 0.05}}).empty());
  const auto changed = declaring({.kind = "coulomb_friction", .joint = 1, .parameters = {1.0, 0.05}});
  REQUIRE(changed.size() == 1);
  CHECK(changed[0].what == "coulomb_friction@2 level_Nm");
  CHECK(changed[0].nominal == 1.0);
  CHECK(changed[0].refitted == 1.48);
  CHECK(changed[0].words ==
        "the declared coulomb friction on joint 2: level went from 1 to 1.48 N·m (+48 %), beyond its "
        "tolerance of "
        "20 %");
}

TEST_CASE("a declared effect that vanished is named with what takes its place") {
  const auto replaced = declaring({.kind = "viscous_friction", .joint = 1, .parameters = {0.4}});
  REQUIRE(replaced.size() == 1);
  CHECK(replaced[0].what == "viscous_friction@2");
  CHECK(std::isnan(replaced[0].refitted));
  CHECK(replaced[0].words ==
        "the declared viscous friction on joint 2 vanished: coulomb friction on joint 2 takes its place");
  const auto gone = declaring({.kind = "torque_bias", .joint = 0, .parameters = {0.4}});
  REQUIRE(gone.size() == 1);
  CHECK(gone[0].words == "the declared torque bias on joint 1 vanished");
}

TEST_CASE("where strengths are logarithms, their torque says whether the strength is known") {
  EffectFinding tissue;
  tissue.kind = "passive_knee_moment";
  tissue.parameters = {{.name = "flexion_log_Nm", .value = -7.0, .ci95 = {-13.0, -1.0}},
                       {.name = "extension_log_Nm", .value = 1.4, .ci95 = {-0.3, 3.1}}};
  tissue.torque_error = 0.42;
  CHECK_FALSE(strengthIsUnknown(tissue));
  tissue.torque_error = 1.37;
  CHECK(strengthIsUnknown(tissue));
}

TEST_CASE("what a variant of an effect lacks does not say that its strength is known") {
  EffectFinding drift;
  drift.kind = "thermal_drift";
  drift.parameters = {{.name = "offset_Nm", .value = 0.0, .ci95 = {0.0, 0.0}},
                      {.name = "friction_Nm", .value = 0.0, .ci95 = {0.0, 0.0}},
                      {.name = "viscous_Nms_rad", .value = -7.9, .ci95 = {-103.0, 87.0}}};
  CHECK(strengthIsUnknown(drift));
  drift.parameters[2].ci95 = {-9.0, -6.8};
  CHECK_FALSE(strengthIsUnknown(drift));
}

TEST_CASE("a reflex whose delay stands where the search ends may be another effect of the velocity") {
  EffectFinding reflex;
  reflex.kind = "spasticity";
  reflex.parameters = {{.name = "gain_Nms_rad", .value = 0.4, .ci95 = {0.3, 0.5}},
                       {.name = "delay_s", .value = 0.01, .ci95 = {-0.01, 0.03}, .at_bound = true}};
  CHECK(mayBeAnother(reflex));
  CHECK_FALSE(strengthIsUnknown(reflex));
  reflex.parameters[1].at_bound = false;
  CHECK_FALSE(mayBeAnother(reflex));
  // Other parameters at an end of the search are to be looked at twice, no more.
  reflex.parameters[0].at_bound = true;
  CHECK_FALSE(mayBeAnother(reflex));
}

TEST_CASE("a ripple that may have half a period more over the joint's range is not known") {
  EffectFinding ripple;
  ripple.kind = "torque_ripple";
  ripple.parameters = {{.name = "amplitude_Nm", .value = 0.1, .ci95 = {0.09, 0.11}},
                       {.name = "cycles_per_rad", .value = 15.0, .ci95 = {14.7, 15.3}}};
  CHECK(periodsAreUnknown(ripple, 2.0));
  CHECK_FALSE(periodsAreUnknown(ripple, 1.5));
  ripple.parameters.pop_back();
  CHECK_FALSE(periodsAreUnknown(ripple, 2.0));
}
