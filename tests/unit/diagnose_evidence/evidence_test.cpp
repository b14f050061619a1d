#include "tools/diagnose/evidence/evidence.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

struct Scene {
  explicit Scene(const Recording& recording)
      : data(std::span(&recording, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0}), moments(data) {
    velocity = moments.append(jointColumns(
        data, 0, {[this](std::size_t s, std::size_t i) { return data.series()[s].states[i].dq[0]; }}));
    target = moments.append(data.driveTorque());
    other = otherFunctions(data, {}, Eigen::MatrixXd(data.rows(), 0));
    other_first = moments.append(other.columns);
  }

  std::vector<Eigen::VectorXd> floor() const { return {Eigen::VectorXd::Constant(moments.bands(), 1e-12)}; }
  double information(const Levels& levels) const {
    double sum = 0.0;
    for (int b = 0; b < moments.bands(); ++b) {
      sum += moments.products(0, b)(velocity, velocity) / levels.noise[0][b];
    }
    return sum;
  }

  Dataset data;
  Moments moments;
  Eigen::Index velocity = 0, target = 0, other_first = 0;
  Other other, none;
};

// Only noise and what is missing: no rigid body.
Recording bareTorque(double noise_Nm, const std::function<double(const Motion&)>& missing) {
  Recording recording = swinging(40.0, noise_Nm, missing);
  const Recording rigid = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    recording.torque_Nm[0][i] -= rigid.torque_Nm[0][i];
  }
  return recording;
}

TEST_CASE("a tenth of the looks is a tenth of the information") {
  const Recording recording = bareTorque(0.05, [](const Motion& motion) { return 0.02 * motion.dq; });
  const Scene scene(recording);
  Evidence evidence(scene.moments, scene.none, scene.other_first, scene.floor());
  const Levels levels = evidence.usual(scene.target, 0.0);
  const std::vector<Parameter> any{{scene.velocity, 1e6}};
  const Posterior all = evidence.of(any, scene.target, levels, 0);
  evidence.countAsIndependent({0.1});
  const Posterior few = evidence.of(any, scene.target, levels, 0);
  CHECK(few.mean[0] == doctest::Approx(all.mean[0]));
  CHECK(few.covariance(0, 0) == doctest::Approx(10.0 * all.covariance(0, 0)));
}

TEST_CASE("a column's evidence at fixed levels is the Bayes factor of one normal coefficient") {
  const Recording recording = bareTorque(0.05, [](const Motion& motion) { return 0.02 * motion.dq; });
  const Scene scene(recording);
  const Evidence evidence(scene.moments, scene.none, scene.other_first, scene.floor());
  const Levels levels = evidence.usual(scene.target, 0.0);
  const double sd = 0.1;
  const double without = evidence.of({}, scene.target, levels, 0).score;
  const Posterior with = evidence.of(std::vector<Parameter>{{scene.velocity, sd}}, scene.target, levels, 0);
  const double information = scene.information(levels);
  double product = 0.0;
  for (int b = 0; b < scene.moments.bands(); ++b) {
    product += scene.moments.products(0, b)(scene.velocity, scene.target) / levels.noise[0][b];
  }
  const double precision = information + 1.0 / (sd * sd);
  CHECK(with.mean[0] == doctest::Approx(product / precision));
  CHECK(with.covariance(0, 0) == doctest::Approx(1.0 / precision));
  CHECK(with.score - without ==
        doctest::Approx(0.5 * product * product / precision - 0.5 * std::log(1.0 + sd * sd * information)));
  const auto beside = evidence.beside({}, scene.target, levels, std::vector<Eigen::Index>{scene.velocity});
  CHECK(beside.information(0, 0) == doctest::Approx(information));
  CHECK(beside.product[0] == doctest::Approx(product));
}

TEST_CASE("levels of noise are found, and the coefficient within what they allow") {
  const double noise_Nm = 0.05, coefficient = 0.02;
  const Recording recording =
      bareTorque(noise_Nm, [=](const Motion& motion) { return coefficient * motion.dq; });
  const Scene scene(recording);
  const Evidence evidence(scene.moments, scene.none, scene.other_first, scene.floor());
  const Posterior found = evidence.of(std::vector<Parameter>{{scene.velocity, 1.0}}, scene.target,
                                      evidence.usual(scene.target, 0.0), 20);
  // White noise of 200 Hz keeps its density per hertz when it is thinned out behind the band's edge.
  const double expected = noise_Nm * noise_Nm * scene.data.rate_Hz() / 200.0;
  double mean = 0.0;
  for (int b = 0; b < scene.moments.bands(); ++b) {
    mean += scene.moments.coefficients(b) * found.levels.noise[0][b] / scene.moments.coefficients();
  }
  CHECK(mean == doctest::Approx(expected).epsilon(0.25));
  CHECK(std::abs(found.mean[0] - coefficient) < 4.0 * std::sqrt(found.covariance(0, 0)));
}

TEST_CASE("what is a smooth function of the motion is held by other functions, and noise is not") {
  const Recording structured =
      bareTorque(0.02, [](const Motion& motion) { return 0.3 * std::cos(4.0 * motion.q); });
  const Recording noisy = bareTorque(0.02, [](const Motion&) { return 0.0; });
  const auto gain = [](const Recording& recording) {
    const Scene scene(recording);
    const Evidence with(scene.moments, scene.other, scene.other_first, scene.floor());
    const Evidence without(scene.moments, scene.none, scene.other_first, scene.floor());
    return with.of({}, scene.target, with.usual(scene.target, 0.1), 30).score -
           without.of({}, scene.target, without.usual(scene.target, 0.0), 30).score;
  };
  CHECK(gain(structured) > 50.0);
  CHECK(gain(noisy) < 10.0);
}

}  // namespace
}  // namespace patella::diagnose::evidence
