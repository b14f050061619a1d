// Torque, residual and motion over time.
#include "tools/diagnose/output/time_figures.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;
using namespace patella::diagnose;
using report::Figure;

namespace {

const Figure& figureWith(const std::vector<Figure>& figures, const std::string& title) {
  const auto found = std::find_if(figures.begin(), figures.end(),
                                  [&](const Figure& figure) { return figure.title.starts_with(title); });
  INFO(title);
  REQUIRE(found != figures.end());
  return *found;
}

}  // namespace

TEST_CASE("each joint has its torque, residual and motion, all of which can be looked into") {
  const auto figures = timeFigures(test::madeUpDiagnosis());
  CHECK(figures.size() == 6);
  CHECK(std::all_of(figures.begin(), figures.end(), [](const Figure& figure) { return figure.zoom; }));
}

TEST_CASE("modelled torque is the measured one less the residual") {
  const Diagnosis diagnosis = test::madeUpDiagnosis();
  const auto figures = timeFigures(diagnosis);
  const Figure& torque = figureWith(figures, "Torque of joint 2");
  CHECK(torque.y_label == "torque / N·m");
  REQUIRE(torque.series.size() == 3);
  CHECK(torque.series[0].label == "measured");
  const JointCurves& curves = diagnosis.curves[1];
  CHECK(torque.series[0].y[5] == curves.torque_Nm[5]);
  CHECK(torque.series[1].y[5] == curves.torque_Nm[5] - curves.residual_before_Nm[5]);
  CHECK(torque.series[2].y[5] == curves.torque_Nm[5] - curves.residual_after_Nm[5]);
}

TEST_CASE("recordings stand one after the other, and what was held out is shaded") {
  const auto figures = timeFigures(test::madeUpDiagnosis());
  const Figure& time = figureWith(figures, "Residual of joint 2, rms");
  CHECK(time.x_label == "time, one stretch after the other / s");
  REQUIRE(time.shades.size() == 1);
  CHECK(time.shades[0].to == doctest::Approx(time.x_range->second));
  CHECK(time.x_range->second == doctest::Approx(20.0 + 12.0).epsilon(0.1));
  for (const report::Series& series : time.series) {
    CHECK(std::is_sorted(series.x.begin(), series.x.end()));
    CHECK(std::count_if(series.y.begin(), series.y.end(), [](double y) { return std::isnan(y); }) == 4);
  }
}

TEST_CASE("simulated motion stands beside the measured one, and leaves the picture where it runs away") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  const auto figures = timeFigures(diagnosis);
  const Figure& motion = figureWith(figures, "Position of joint 2, rms error 0.31 → – rad");
  CHECK(motion.section.find("windows of 0.5 s") != std::string::npos);
  REQUIRE(motion.series.size() == 3);
  const SimulatedMotion& given = diagnosis.before.simulated[1];
  CHECK(motion.series[0].y[1] == given.measured_rad[1]);
  CHECK(motion.series[1].y[1] == given.simulated_rad[1]);
  // The second recording begins anew.
  for (const report::Series& series : motion.series) {
    CHECK(std::is_sorted(series.x.begin(), series.x.end()));
  }
  diagnosis.before.simulated[1].simulated_rad[1] = 50.0;
  const auto away = timeFigures(diagnosis);
  CHECK(std::isnan(figureWith(away, "Position of joint 2").series[1].y[1]));
}

TEST_CASE("postures and a diagnosis without curves have no figures over time") {
  CHECK(timeFigures(test::madeUpPostures()).empty());
  CHECK(timeFigures(Diagnosis{}).empty());
}
