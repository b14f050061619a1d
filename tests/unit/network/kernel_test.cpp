// The kernel's functions, in every variant that this processor has, against the standard library in double.
#include "core/network/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "core/network/inference_options.hpp"
#include "core/network/packed_matrix.hpp"

namespace patella::network {

namespace {

using kernel::Functions;
using kernel::kHeadLanes;
using kernel::kInt16One;
using kernel::kPanel;

/// tanh of numbers as it comes out of product_tanh.
std::vector<float> tanhOf(const Functions& functions, const std::vector<float>& arguments) {
  const int count = static_cast<int>(arguments.size());
  const PackedMatrix zero(Eigen::MatrixXd::Zero(count, 1));
  AlignedFloats y(zero.paddedRows());
  std::copy(arguments.begin(), arguments.end(), y.data());
  const float x = 0.0F;
  functions.tanh_of({zero.view(), &x}, zero.paddedRows(), y.data(), y.data());
  return {y.data(), y.data() + count};
}

std::vector<float> tanhArguments() {
  std::vector<float> arguments;
  for (double x = -12.0; x <= 12.0; x += 1.0 / 4096.0)
    arguments.push_back(static_cast<float>(x));
  for (double x = 1e-30; x < 1.0; x *= 1.7)
    arguments.push_back(static_cast<float>(x));
  return arguments;
}

/// One head of one channel and one output, over an otherwise empty ring of a panel.
struct TinyAttention {
  TinyAttention()
      : newest(kPanel), keys(32), values(32), query(kHeadLanes), weights(kernel::kWeightPadding) {}

  double attend(const Functions& functions, int slot, int count) {
    double result = 1.0;
    functions.attend({.layout = {.groups = 1,
                                 .heads = 1,
                                 .steps = kHeadLanes,
                                 .head_channels = 1,
                                 .outputs = 1,
                                 .blocks = 4,
                                 .query_rows = 1},
                      .newest = newest.data(),
                      .keys = keys.data(),
                      .values = values.data(),
                      .query = query.data(),
                      .weights = weights.data(),
                      .slot = slot,
                      .count = count},
                     &result);
    return result;
  }

  AlignedFloats newest;
  AlignedFloats keys;
  AlignedFloats values;
  AlignedFloats query;
  AlignedFloats weights;
};

Eigen::MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); })
      .cast<float>()
      .cast<double>();
}

}  // namespace

TEST_CASE("tanh is accurate over its whole range, saturates, and passes NaN and infinity on") {
  const std::vector<float> arguments = tanhArguments();
  for (const InstructionSet set : availableInstructionSets()) {
    CAPTURE(nameOf(set));
    const Functions& functions = kernel::functionsFor(set);
    const std::vector<float> values = tanhOf(functions, arguments);
    double worst = 0.0;
    double worst_relative = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double exact = std::tanh(static_cast<double>(arguments[i]));
      const double error = std::abs(static_cast<double>(values[i]) - exact);
      worst = std::max(worst, error);
      if (exact != 0.0)
        worst_relative = std::max(worst_relative, error / std::abs(exact));
      CHECK(std::abs(values[i]) <= 1.0F);
    }
    MESSAGE(nameOf(set) << ": tanh error " << worst << ", relative " << worst_relative);
    CHECK(worst < 2e-7);
    CHECK(worst_relative < 3e-7);

    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> special = tanhOf(
        functions, {kInfinity, -kInfinity, kNaN, -0.3F, 0.3F, std::numeric_limits<float>::max(), 0.0F});
    CHECK(special[0] == 1.0F);
    CHECK(special[1] == -1.0F);
    CHECK(std::isnan(special[2]));
    CHECK(special[3] == doctest::Approx(-special[4]).epsilon(3e-7));
    CHECK(special[5] == 1.0F);
    CHECK(special[6] == 0.0F);
  }
}

TEST_CASE("a packed product equals Eigen's for sizes on either side of a panel and a column block") {
  for (const InstructionSet set : availableInstructionSets())
    for (const Eigen::Index rows : {1, 31, 32, 33, 144})
      for (const Eigen::Index cols : {1, 5, 16, 17, 128}) {
        CAPTURE(nameOf(set));
        const Eigen::MatrixXd matrix = randomMatrix(rows, cols, 3);
        const Eigen::VectorXf x = randomMatrix(cols, 1, 4).cast<float>();
        const PackedMatrix packed(matrix);
        AlignedFloats y(packed.paddedRows());
        y.data()[0] = 2.0F;
        kernel::functionsFor(set).product({packed.view(), x.data()}, y.data(), y.data());
        Eigen::VectorXd expected = matrix * x.cast<double>();
        expected[0] += 2.0;
        for (Eigen::Index row = 0; row < packed.paddedRows(); ++row)
          CHECK(std::abs(static_cast<double>(y.data()[row]) - (row < rows ? expected[row] : 0.0)) < 2e-6);
      }
}

TEST_CASE("an int16 product errs by the rounding of weights and activations, and does not overflow") {
  for (const InstructionSet set : availableInstructionSets())
    for (const Eigen::Index rows : {1, 33, 144})
      for (const Eigen::Index cols : {1, 2, 31, 33, 128})
        for (const bool extreme : {false, true}) {
          CAPTURE(nameOf(set));
          CAPTURE(rows);
          CAPTURE(cols);
          const Functions& functions = kernel::functionsFor(set);
          // All products of one sign and of the largest size: the worst that the sums can meet.
          Eigen::MatrixXd matrix = randomMatrix(rows, cols, 5);
          if (extreme)
            matrix.setConstant(-3.0);
          Eigen::VectorXf x = randomMatrix(cols, 1, 6).cast<float>();
          if (extreme)
            x.setOnes();
          const PackedInt16Matrix packed(matrix);
          AlignedFloats padded(roundUpToPanel(static_cast<int>(cols)));
          std::copy_n(x.data(), cols, padded.data());
          AlignedArray<std::int16_t> rounded(padded.size());
          CHECK(functions.quantise(padded.data(), padded.size(), rounded.data()) == 0.0F);
          AlignedFloats y(packed.paddedRows());
          y.data()[0] = 2.0F;
          functions.product_int16({packed.view(), rounded.data()}, y.data(), y.data());
          Eigen::VectorXd expected = matrix * x.cast<double>();
          expected[0] += 2.0;
          const double tolerance = (extreme ? 3.0 : 1.0) * static_cast<double>(cols) * 1.3e-4 + 1e-6;
          for (Eigen::Index row = 0; row < packed.paddedRows(); ++row)
            CHECK(std::abs(static_cast<double>(y.data()[row]) - (row < rows ? expected[row] : 0.0)) <
                  tolerance);
        }
}

TEST_CASE("rounding to int16 says when a number was not finite") {
  for (const InstructionSet set : availableInstructionSets()) {
    const Functions& functions = kernel::functionsFor(set);
    AlignedFloats x(2 * kPanel);
    AlignedArray<std::int16_t> y(2 * kPanel);
    x.data()[3] = 1.0F;
    x.data()[4] = -1.0F;
    x.data()[63] = 0.25F;
    CHECK(functions.quantise(x.data(), x.size(), y.data()) == 0.0F);
    CHECK(y.data()[3] == kInt16One);
    CHECK(y.data()[4] == -kInt16One);
    CHECK(y.data()[63] == kInt16One / 4);
    CHECK(y.data()[0] == 0);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
      for (const int at : {0, 31, 37}) {
        x.setZero();
        x.data()[at] = bad;
        CHECK(std::isnan(functions.quantise(x.data(), x.size(), y.data())));
      }
  }
}

TEST_CASE("attention over few, far apart scores picks the largest without overflow") {
  for (const InstructionSet set : availableInstructionSets()) {
    CAPTURE(nameOf(set));
    const Functions& functions = kernel::functionsFor(set);
    TinyAttention tiny;
    tiny.keys.data()[0] = -3.0F;
    tiny.keys.data()[1] = 2.0F;
    tiny.values.data()[0] = 10.0F;
    tiny.values.data()[1] = 20.0F;
    const float newest[] = {1e4F, 1.0F, 30.0F};
    std::copy_n(newest, 3, tiny.newest.data());
    CHECK(tiny.attend(functions, 2, 3) == doctest::Approx(21.0));

    // Equal scores, all far below those that the empty slots' zero keys would get: the mean of what is there.
    const float equal[] = {-1e4F, 5.0F, 30.0F};
    std::copy_n(equal, 3, tiny.newest.data());
    std::fill_n(tiny.keys.data(), 2, 5.0F);
    CHECK(tiny.attend(functions, 2, 3) == doctest::Approx(21.0));
  }
}

TEST_CASE("every variant, on every machine, gives the same bits") {
  // Numbers without a library's help, which may round a sine or draw a random number differently.
  std::uint32_t state = 1;
  const auto fill = [&state](AlignedFloats& numbers, float width) {
    for (int i = 0; i < numbers.size(); ++i) {
      state = state * 1664525U + 1013904223U;
      numbers.data()[i] = (static_cast<float>(state >> 8U) * 0x1p-23F - 1.0F) * width;
    }
  };
  const kernel::HeadLayout layout{
      .groups = 1, .heads = 4, .steps = 2, .head_channels = 5, .outputs = 2, .blocks = 19, .query_rows = 20};
  AlignedFloats weights(96 * 40);
  AlignedFloats x(64);
  AlignedFloats start(96);
  AlignedFloats keys(layout.blocks * layout.head_channels * kHeadLanes);
  AlignedFloats values(layout.blocks * layout.outputs * kHeadLanes);
  AlignedFloats old_cell(32);
  for (AlignedFloats* numbers : {&weights, &x, &start, &keys, &values, &old_cell})
    fill(*numbers, 1.0F);
  for (const InstructionSet set : availableInstructionSets()) {
    CAPTURE(nameOf(set));
    const Functions& functions = kernel::functionsFor(set);
    AlignedFloats y(96);
    const kernel::FloatMatrix matrix{.data = weights.data(), .padded_rows = 96, .cols = 40};
    functions.product({matrix, x.data()}, start.data(), y.data());
    AlignedFloats gates(96);
    functions.tanh_of({matrix, y.data()}, 96, start.data(), gates.data());
    AlignedFloats cell(32);
    std::copy_n(old_cell.data(), 32, cell.data());
    AlignedFloats hidden(32);
    functions.lstm_cell(gates.data(), 24, cell.data(), hidden.data());
    AlignedFloats query(layout.head_channels * kHeadLanes);
    AlignedFloats scores(roundUp(layout.blocks * kHeadLanes, kernel::kWeightPadding));
    double result[2] = {};
    functions.attend({.layout = layout,
                      .newest = y.data(),
                      .keys = keys.data(),
                      .values = values.data(),
                      .query = query.data(),
                      .weights = scores.data(),
                      .slot = 36,
                      .count = 37},
                     result);
    // Fowler, Noll and Vo's hash over all of it.
    std::uint64_t hash = 14695981039346656037U;
    const auto mix = [&hash](const auto* numbers, int count) {
      for (int i = 0; i < count; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &numbers[i], sizeof(numbers[i]));
        hash = (hash ^ bits) * 1099511628211U;
      }
    };
    mix(y.data(), 96);
    mix(gates.data(), 96);
    mix(hidden.data(), 24);
    mix(result, 2);
    CHECK(hash == 6877106466326508636U);
  }
}

TEST_CASE("a set that the processor lacks is refused by name") {
  const std::vector<InstructionSet> sets = availableInstructionSets();
  REQUIRE(sets.front() == InstructionSet::kBaseline);
  CHECK(&kernel::functionsFor({}) == &kernel::functionsFor(sets.back()));
  for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512})
    if (std::find(sets.begin(), sets.end(), set) == sets.end())
      CHECK_THROWS_WITH_AS(kernel::functionsFor(set), doctest::Contains(nameOf(set).c_str()),
                           std::invalid_argument);
}

}  // namespace patella::network
