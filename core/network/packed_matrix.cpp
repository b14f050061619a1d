#include "core/network/packed_matrix.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace patella::network {

namespace {

using kernel::kInt16Block;
using kernel::kInt16One;
using kernel::kPanel;

void checkRange(const Eigen::MatrixXd& matrix) {
  if (!matrix.cast<float>().allFinite())
    throw std::invalid_argument("weights multiplied out exceed the range of float32");
}

/// Largest factor for the weights of a row; 0 for a row of zeros.
double int16Scale(const Eigen::RowVectorXd& row) {
  constexpr double kLargestWeight = std::numeric_limits<std::int16_t>::max();
  // Rounding adds half a unit a weight at most.
  constexpr double kLargestSum =
      static_cast<double>(std::numeric_limits<std::int32_t>::max()) / kInt16One - 0.5 * kInt16Block;
  const double largest = row.cwiseAbs().maxCoeff();
  // Below this the scale's inverse is no float32, and the products vanish beside any other number.
  if (largest < 1e-30)
    return 0.0;
  double sum = 0.0;
  for (Eigen::Index first = 0; first < row.size(); first += kInt16Block)
    sum = std::max(
        sum, row.segment(first, std::min<Eigen::Index>(kInt16Block, row.size() - first)).cwiseAbs().sum());
  return std::min(kLargestWeight / largest, kLargestSum / sum);
}

}  // namespace

PackedMatrix::PackedMatrix(const Eigen::MatrixXd& matrix)
    : padded_rows_(roundUpToPanel(static_cast<int>(matrix.rows()))),
      cols_(static_cast<int>(matrix.cols())),
      data_(padded_rows_ * cols_) {
  checkRange(matrix);
  float* next = data_.data();
  for (Eigen::Index panel = 0; panel < padded_rows_; panel += kPanel)
    for (Eigen::Index col = 0; col < matrix.cols(); ++col)
      for (Eigen::Index row = panel; row < panel + kPanel; ++row)
        *next++ = row < matrix.rows() ? static_cast<float>(matrix(row, col)) : 0.0F;
}

PackedInt16Matrix::PackedInt16Matrix(const Eigen::MatrixXd& matrix)
    : padded_rows_(roundUpToPanel(static_cast<int>(matrix.rows()))),
      padded_cols_(roundUp(static_cast<int>(matrix.cols()), 2)),
      row_scale_(padded_rows_),
      data_(padded_rows_ * padded_cols_) {
  checkRange(matrix);
  for (int row = 0; row < static_cast<int>(matrix.rows()); ++row) {
    const double scale = int16Scale(matrix.row(row));
    if (scale == 0.0)
      continue;
    row_scale_.data()[row] = static_cast<float>(1.0 / (scale * kInt16One));
    std::int16_t* panel = data_.data() + row / kPanel * kPanel * padded_cols_ + row % kPanel * 2;
    for (int col = 0; col < static_cast<int>(matrix.cols()); ++col)
      panel[col / 2 * 2 * kPanel + col % 2] =
          static_cast<std::int16_t>(std::lround(matrix(row, col) * scale));
  }
}

}  // namespace patella::network
