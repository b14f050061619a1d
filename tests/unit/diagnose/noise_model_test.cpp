// The noise that chance is drawn from.
#include "tools/diagnose/regression/noise_model.hpp"

#include <random>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"
#include "tools/diagnose/regression/dataset.hpp"

using namespace patella::diagnose;

namespace {

Eigen::VectorXd firstOrder(Eigen::Index rows, double keep, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(rows);
  double value = 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    value = keep * value + normal(random);
    noise[i] = value;
  }
  return noise;
}

double correlationAtOne(const Eigen::VectorXd& x) {
  return x.head(x.size() - 1).dot(x.tail(x.size() - 1)) / x.squaredNorm();
}

}  // namespace

TEST_CASE("an autoregression finds the coefficient that made the noise") {
  const Recording recording = swing(120.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const Eigen::VectorXd noise = firstOrder(data.rows(), 0.8, 3);
  const Autoregression process = Autoregression::fit(data, noise, 1, 0.0);
  CHECK(process.coefficients[0][0] == doctest::Approx(0.8).epsilon(0.05));
  // White noise that is assumed in it draws the coefficient towards zero: r1 / (r0 · 1.5).
  CHECK(Autoregression::fit(data, noise, 1, 0.5).coefficients[0][0] ==
        doctest::Approx(0.8 / 1.5).epsilon(0.06));
}

TEST_CASE("what a noise process draws has the spread and the memory of what it was fitted to") {
  const Recording recording = swing(120.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const Eigen::VectorXd noise = firstOrder(data.rows(), 0.7, 5);
  const NoiseProcess process(data, noise);
  CHECK(process.order() >= 1);
  std::mt19937_64 random(7);
  double square = 0.0, memory = 0.0;
  constexpr int kDraws = 40;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd drawn = process.draw(random);
    REQUIRE(drawn.size() == noise.size());
    square += drawn.squaredNorm() / kDraws;
    memory += correlationAtOne(drawn) / kDraws;
  }
  CHECK(square == doctest::Approx(noise.squaredNorm()).epsilon(0.1));
  CHECK(memory == doctest::Approx(correlationAtOne(noise)).epsilon(0.05));
}

TEST_CASE(
    "a weighted residual has unit variance, and half the residual a lower objective by rows times log 4") {
  const Recording recording = swing(60.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const Eigen::VectorXd noise = firstOrder(data.rows(), 0.7, 9);
  const Weighting weighting(data, noise);
  const Eigen::MatrixXd weighted = weighting.apply(noise);
  CHECK(weighted.squaredNorm() / static_cast<double>(weighted.rows()) == doctest::Approx(1.0));
  CHECK(weighting.objective(noise) - weighting.objective(0.5 * noise) ==
        doctest::Approx(static_cast<double>(weighting.rows()) * std::log(4.0)));
}

TEST_CASE("a product with draws has the variance that the process says") {
  const Recording recording = swing(20.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const NoiseProcess process(data, firstOrder(data.rows(), 0.9, 11));
  const Eigen::VectorXd column = data.time_s().array().sin().matrix();
  std::mt19937_64 random(13);
  double square = 0.0;
  constexpr int kDraws = 2000;
  for (int i = 0; i < kDraws; ++i) {
    square += std::pow(column.dot(process.draw(random)), 2) / kDraws;
  }
  CHECK(process.variance(column) == doctest::Approx(square).epsilon(0.1));
}

TEST_CASE("a product of a weighted residual is that of the residual with what the transposed map gives") {
  const Recording recording = swing(60.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const Eigen::VectorXd noise = firstOrder(data.rows(), 0.7, 9);
  const Weighting weighting(data, noise);
  const Eigen::MatrixXd weights = firstOrder(weighting.rows(), 0.2, 10);
  CHECK(weights.col(0).dot(weighting.apply(noise).col(0)) ==
        doctest::Approx(weighting.transposed(weights).col(0).dot(noise)));
}

TEST_CASE("joint by joint, a column keeps the evidence that noise which joints share takes from it") {
  Recording recording = swing(60.0);
  recording.joints = 2;
  recording.position_rad[1] = recording.position_rad[0];
  recording.torque_Nm[1] = recording.torque_Nm[0];
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const Eigen::VectorXd shared = firstOrder(data.rows(), 0.5, 3);
  Eigen::VectorXd residual(2 * data.rows());
  residual << shared + 0.1 * firstOrder(data.rows(), 0.5, 5), shared + 0.1 * firstOrder(data.rows(), 0.5, 7);
  const Weighting together(data, residual);
  CHECK(together.correlation() > 0.95);
  const Weighting apart = together.jointByJoint();
  CHECK(apart.correlation() < 1e-6);
  Eigen::VectorXd column = residual;
  column.head(data.rows()).setZero();
  const auto gain = [&](const Weighting& weighting) {
    const Eigen::VectorXd own = weighting.apply(column).col(0);
    return std::pow(own.dot(weighting.apply(residual).col(0)), 2) / own.squaredNorm();
  };
  CHECK(gain(together) < 0.1 * gain(apart));
  // In units of each joint's own deviation.
  CHECK(apart.apply(column).col(0).squaredNorm() ==
        doctest::Approx(static_cast<double>(apart.rows())).epsilon(0.01));
}
