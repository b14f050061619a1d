#include "core/network/packed_matrix.hpp"

#include <algorithm>
#include <stdexcept>

namespace patella::network {

AlignedFloats::AlignedFloats(int size)
    : data_(new (kCacheLine) float[static_cast<std::size_t>(size)]()), size_(size) {}

void AlignedFloats::setZero() noexcept {
  std::fill_n(data_.get(), size_, 0.0F);
}

PackedMatrix::PackedMatrix(const Eigen::MatrixXd& matrix)
    : padded_rows_(roundUpToPanel(static_cast<int>(matrix.rows()))),
      cols_(static_cast<int>(matrix.cols())),
      data_(padded_rows_ * cols_) {
  if (!matrix.cast<float>().allFinite())
    throw std::invalid_argument("weights multiplied out exceed the range of float32");
  float* next = data_.data();
  for (Eigen::Index panel = 0; panel < padded_rows_; panel += kPanel)
    for (Eigen::Index col = 0; col < matrix.cols(); ++col)
      for (Eigen::Index row = panel; row < panel + kPanel; ++row)
        *next++ = row < matrix.rows() ? static_cast<float>(matrix(row, col)) : 0.0F;
}

}  // namespace patella::network
