// Which pictures a diagnosis gets, and that they show what they say.
#include "tools/diagnose/output/residual_figures.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"
#include "tools/diagnose/output/residual_variables.hpp"

using namespace patella;
using namespace patella::diagnose;
using report::Figure;

namespace {

const Figure& figureWith(const std::vector<Figure>& figures, const std::string& title,
                         const std::string& x_label) {
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const Figure& figure) {
    return figure.title.starts_with(title) && figure.x_label.find(x_label) != std::string::npos;
  });
  INFO(title << " against " << x_label);
  REQUIRE(found != figures.end());
  return *found;
}

}  // namespace

TEST_CASE("each effect has a picture against the variable that betrays it") {
  const auto figures = residualFigures(test::madeUpDiagnosis());
  // Friction alone: the spring is in the model both times, so that the steps stand level.
  const Figure& friction = figureWith(figures, "Coulomb friction on joint 2", "velocity of joint 2");
  REQUIRE(friction.series.size() == 4);
  const report::Series& without = friction.series[2];
  CHECK(without.label == "without it");
  CHECK(without.y.front() == doctest::Approx(-1.48).epsilon(0.05));
  CHECK(without.y.back() == doctest::Approx(1.48).epsilon(0.05));
  const report::Series& with = friction.series[3];
  CHECK(*std::max_element(with.y.begin(), with.y.end()) < 0.1);
  CHECK(with.error.size() == with.y.size());

  const Figure& spring = figureWith(figures, "Linear stiffness on joint 2", "position of joint 2");
  const report::Series& line = spring.series[2];
  const double slope = (line.y.back() - line.y.front()) / (line.x.back() - line.x.front());
  CHECK(slope == doctest::Approx(4.02).epsilon(0.05));
}

TEST_CASE("a joint without an effect is drawn before and after, against its velocity") {
  const Diagnosis diagnosis = test::madeUpDiagnosis();
  const auto figures = residualFigures(diagnosis);
  CHECK(figureWith(figures, "Residual of joint 1", "velocity of joint 1 / rad/s").series.size() == 4);
  CHECK(std::none_of(figures.begin(), figures.end(),
                     [](const Figure& figure) { return figure.title == "Residual of joint 2"; }));
}

TEST_CASE("what is left is drawn alone, against what it depends on") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  const auto dependsOn = [&](const char* variable) {
    diagnosis.unexplained = {{.joint = 0, .variable = variable, .explained_Nm = 0.02, .p_value = 0.01}};
    return residualFigures(diagnosis);
  };
  const auto figures = dependsOn("ddq1*q2");
  const Figure& rest = figureWith(figures, "Residual of joint 1, ddq1*q2: explains 0.02 N·m rms",
                                  "acceleration of joint 1 / rad/s²");
  CHECK(rest.series.size() == 2);
  figureWith(dependsOn("q2"), "Residual of joint 1, q2", "position of joint 2");
  figureWith(dependsOn("time"), "Residual of joint 1, time", "time / s");
  CHECK(dependsOn("activation3").size() == figures.size() - 1);  // no EMG in these curves
  CHECK(dependsOn("something else").size() == figures.size() - 1);
  for (JointCurves& curves : diagnosis.curves) {
    curves.activation[2] = curves.torque_Nm;
  }
  figureWith(dependsOn("activation3"), "Residual of joint 1, activation3", "activation of EMG channel 3");
}

TEST_CASE("spectrum and autocorrelation have their bands and axes") {
  const auto figures = residualFigures(test::madeUpDiagnosis());
  const Figure& spectrum = figureWith(figures, "Amplitude density of the residual of joint 2", "frequency");
  CHECK(spectrum.log_x);
  CHECK(spectrum.log_y);
  CHECK(spectrum.series[0].y.front() > 50.0 * spectrum.series[1].y.front());
  const Figure& correlation = figureWith(figures, "Autocorrelation of the residual of joint 2", "lag");
  CHECK(correlation.levels.size() == 2);
  CHECK(correlation.levels[0].value ==
        doctest::Approx(1.96 /
                        std::sqrt(static_cast<double>(test::madeUpDiagnosis().curves[0].time_s.size()))));
  CHECK(correlation.series[0].y.front() == 1.0);
}

TEST_CASE("postures have no time, no spectrum and no velocity") {
  const auto figures = residualFigures(test::madeUpPostures());
  REQUIRE(figures.size() == 1);
  CHECK(figures[0].x_label == "position of joint 1 / rad");
}

TEST_CASE("a linear axis has its units, and a diagnosis without curves no figures") {
  Diagnosis diagnosis = test::madeUpPostures();
  diagnosis.extended.mechanism = model::PrismaticJointParameters{};
  CHECK(residualFigures(diagnosis)[0].x_label == "position of joint 1 / m");
  CHECK(residualFigures(diagnosis)[0].y_label == "(drive − model) / N");
  CHECK(residualFigures(Diagnosis{}).empty());
}

TEST_CASE("delays show against the rate of torque, drift against time, EMG against its channel") {
  using Kind = Variable::Kind;
  Diagnosis diagnosis = test::madeUpDiagnosis();
  const auto kindOf = [&](const char* effect) {
    return betrayedBy(diagnosis, {.kind = effect,
                                  .joint = 0,
                                  .parameters = {},
                                  .indistinguishable_from = {},
                                  .replaces = {},
                                  .separating_motion = {}});
  };
  CHECK(kindOf("actuator_delay").kind == Kind::kTorqueRate);
  CHECK(kindOf("rotor_inertia").kind == Kind::kAcceleration);
  CHECK(kindOf("torque_gain").kind == Kind::kTorque);
  CHECK(kindOf("tremor").kind == Kind::kTime);
  CHECK(kindOf("stribeck_friction").kind == Kind::kVelocity);
  diagnosis.extended.effects.push_back({.kind = "emg_torque", .joint = 0, .parameters = {10.0, 3.0, 0.05}});
  CHECK(kindOf("emg_torque") == Variable{.kind = Kind::kActivation, .index = 2});
}
