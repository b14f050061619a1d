// Names and numbers as people read them.
#include "tools/diagnose/result/parameter_text.hpp"

#include <limits>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("a name gives up its unit") {
  CHECK(splitName("level_Nm").words == "level");
  CHECK(splitName("level_Nm").unit == "N·m");
  CHECK(splitName("smoothing_velocity_rad_s").unit == "rad/s");
  CHECK(splitName("viscous_positive_Nms_rad").words == "viscous positive");
  CHECK(splitName("extension_knee_1_rad").unit == "1/rad");
  CHECK(splitName("gain_error").words == "gain error");
  CHECK(splitName("gain_error").unit.empty());
}

TEST_CASE("a linear axis has units of its own for the same names") {
  Diagnosis diagnosis;
  CHECK(unitsOf(diagnosis).torque == "N·m");
  diagnosis.extended.mechanism = model::PrismaticJointParameters{.mass_kg = 95.0};
  const Units units = unitsOf(diagnosis);
  CHECK(units.torque == "N");
  CHECK(splitName("coefficient_Nms_rad", units).unit == "N·s/m");
  CHECK(splitName("rest_position_rad", units).unit == "m");
  CHECK(splitName("delay_s", units).unit == "s");
}

TEST_CASE("every physical parameter of the library has words") {
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    for (const model::EffectParameter& parameter : effect->parameters) {
      CAPTURE(parameter.name);
      const ParameterName name = splitName(parameter.name);
      CHECK_FALSE(name.words.empty());
      // Text that looks like a unit has been understood as one.
      for (const char* left : {" Nm", " rad", " kg", " Hz", " s"}) {
        CHECK_FALSE(name.words.ends_with(left));
      }
    }
  }
}

TEST_CASE("labels of effects and sums") {
  CHECK(effectWords("payload@2") == "payload on joint 2");
  CHECK(effectWords("viscous_friction@1+torque_bias") == "viscous friction on joint 1 + torque bias");
  CHECK(effectWords("nominal I2 + m2 lc2²") == "nominal I2  +  m2 lc2²");
}

TEST_CASE("an effect whose parameters are logarithms says how well its torque is known") {
  EffectFinding finding;
  CHECK(torqueErrorText(finding).empty());
  finding.torque_error = 0.4249;
  CHECK(torqueErrorText(finding) == ", its torque within 42 %");
  finding.torque_error = 1.2;
  CHECK(torqueErrorText(finding).empty());
}

TEST_CASE("an estimate shows as many digits as its interval supports") {
  CHECK(valueWithInterval(1.48321, {1.42144, 1.54398}) == "1.48 [1.42, 1.54]");
  CHECK(valueWithInterval(4.0213, {3.911, 4.1316}) == "4.02 [3.91, 4.13]");
  CHECK(valueWithInterval(203.5, {180.0, 227.0}) == "204 [180, 227]");
  CHECK(valueWithInterval(0.0003, {-0.0071, 0.0083}) == "0.0003 [-0.0071, 0.0083]");
  CHECK(valueWithInterval(1e-9, {-0.0071, 0.0083}) == "0.000 [-0.007, 0.008]");
  CHECK(valueWithInterval(1.5, {1.5, 1.5}) == "1.5");
  CHECK(valueWithInterval(2.71, {0.2513, 34.2}) == "2.7 [0.25, 34]");
  CHECK(valueWithInterval(8109.0, {738.2, 89141.0}) == "8109 [738, 89141]");
  CHECK(valueWithInterval(2.31e-9, {2.2e-9, 2.4e-9}) == "2.31e-09 [2.2e-09, 2.4e-09]");
  CHECK(estimateText({.name = "level_Nm", .value = 1.48321, .ci95 = {1.42144, 1.54398}}) ==
        "level 1.48 [1.42, 1.54] N·m");
  CHECK(shortNumber(std::numeric_limits<double>::quiet_NaN()) == "–");
  CHECK(shortNumber(0.0123456) == "0.0123");
}
