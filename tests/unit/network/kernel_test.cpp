// The kernel's functions against the standard library's in double.
#include "core/network/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace patella::network {

TEST_CASE("tanh is accurate over its whole range, odd, and passes NaN and infinity on") {
  std::vector<float> arguments;
  for (double x = -12.0; x <= 12.0; x += 1.0 / 4096.0)
    arguments.push_back(static_cast<float>(x));
  for (double x = 1e-30; x < 1.0; x *= 1.7)
    arguments.push_back(static_cast<float>(x));
  arguments.resize(static_cast<std::size_t>(roundUpToPanel(static_cast<int>(arguments.size()))), 0.0F);
  std::vector<float> values = arguments;
  kernel::tanhInPlace(values.data(), static_cast<int>(values.size()));
  double worst = 0.0;
  double worst_relative = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double exact = std::tanh(static_cast<double>(arguments[i]));
    const double error = std::abs(static_cast<double>(values[i]) - exact);
    worst = std::max(worst, error);
    if (exact != 0.0)
      worst_relative = std::max(worst_relative, error / std::abs(exact));
  }
  CHECK(worst < 1e-7);
  CHECK(worst_relative < 2e-7);

  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> special(kPanel, 0.3F);
  special[0] = kInfinity;
  special[1] = -kInfinity;
  special[2] = std::numeric_limits<float>::quiet_NaN();
  special[3] = -0.3F;
  special[4] = std::numeric_limits<float>::max();
  kernel::tanhInPlace(special.data(), kPanel);
  CHECK(special[0] == 1.0F);
  CHECK(special[1] == -1.0F);
  CHECK(std::isnan(special[2]));
  CHECK(special[3] == -special[5]);
  CHECK(special[4] == 1.0F);
}

TEST_CASE("a packed product equals Eigen's for sizes on either side of a panel and a column block") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const Eigen::Index rows : {1, 31, 32, 33, 144})
    for (const Eigen::Index cols : {1, 5, 16, 17, 128}) {
      const Eigen::MatrixXd matrix = Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); })
                                         .cast<float>()
                                         .cast<double>();
      const Eigen::VectorXf x =
          Eigen::VectorXd::NullaryExpr(cols, [&] { return uniform(random); }).cast<float>();
      const PackedMatrix packed(matrix);
      AlignedFloats y(packed.paddedRows());
      y.data()[0] = 2.0F;
      kernel::addProduct(packed, x.data(), y.data());
      Eigen::VectorXd expected = matrix * x.cast<double>();
      expected[0] += 2.0;
      for (Eigen::Index row = 0; row < packed.paddedRows(); ++row)
        CHECK(std::abs(static_cast<double>(y.data()[row]) - (row < rows ? expected[row] : 0.0)) < 2e-6);
    }
}

TEST_CASE("attention over few, far apart scores picks the largest without overflow") {
  constexpr int kSteps = 3;
  AlignedFloats query(kPanel);
  AlignedFloats keys(kPanel);
  AlignedFloats values(kPanel);
  AlignedFloats scratch(kPanel);
  query.data()[0] = 1e4F;
  const float key_of_step[kSteps] = {-3.0F, 2.0F, 1.0F};
  const float value_of_step[kSteps] = {10.0F, 20.0F, 30.0F};
  std::copy_n(key_of_step, kSteps, keys.data());
  std::copy_n(value_of_step, kSteps, values.data());
  kernel::AttentionView view{.query = query.data(),
                             .keys = keys.data(),
                             .values = values.data(),
                             .weights = scratch.data(),
                             .heads = 1,
                             .head_channels = 1,
                             .outputs = 1,
                             .stride = kPanel,
                             .count = kSteps};
  double result = 1.0;
  kernel::attend(view, &result);
  CHECK(result == doctest::Approx(21.0));

  // Equal scores, all far below those that the empty slots' zero keys would get: the mean of what is there.
  query.data()[0] = -1e4F;
  std::fill_n(keys.data(), kSteps, 5.0F);
  result = 0.0;
  kernel::attend(view, &result);
  CHECK(result == doctest::Approx(20.0));
}

}  // namespace patella::network
