// Flat, aligned storage in the order in which the kernel reads it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>

#include <Eigen/Core>

#include "core/network/kernel.hpp"

namespace patella::network {

constexpr int roundUp(int count, int multiple) noexcept {
  return (count + multiple - 1) / multiple * multiple;
}

constexpr int roundUpToPanel(int count) noexcept {
  return roundUp(count, kernel::kPanel);
}

/// Zeroed numbers that begin on a cache line.
template <typename Number>
class AlignedArray {
 public:
  explicit AlignedArray(int size)
      : data_(new (kCacheLine) Number[static_cast<std::size_t>(size)]()), size_(size) {}

  Number* data() noexcept { return data_.get(); }
  const Number* data() const noexcept { return data_.get(); }
  int size() const noexcept { return size_; }
  void setZero() noexcept { std::fill_n(data_.get(), size_, Number{}); }

 private:
  static constexpr std::align_val_t kCacheLine{64};
  struct Free {
    void operator()(Number* data) const noexcept { ::operator delete[](data, kCacheLine); }
  };
  std::unique_ptr<Number[], Free> data_;
  int size_;
};

using AlignedFloats = AlignedArray<float>;

/// A matrix in panels of kPanel rows, each panel column after column: a product reads it once, front to back.
/// Missing rows of the last panel are zero.
class PackedMatrix {
 public:
  /// Rounds to float; throws std::invalid_argument where an element is beyond its range.
  explicit PackedMatrix(const Eigen::MatrixXd& matrix);

  int paddedRows() const noexcept { return padded_rows_; }
  kernel::FloatMatrix view() const noexcept { return {data_.data(), padded_rows_, cols_}; }

 private:
  int padded_rows_;
  int cols_;
  AlignedFloats data_;
};

/// The same in 16 bits, with one scale a row: the largest at which neither a weight nor the sum of
/// kInt16Block products with activations up to 1 overflows.
class PackedInt16Matrix {
 public:
  /// Throws std::invalid_argument where an element is beyond the range of float32.
  explicit PackedInt16Matrix(const Eigen::MatrixXd& matrix);

  int paddedRows() const noexcept { return padded_rows_; }
  kernel::Int16Matrix view() const noexcept {
    return {data_.data(), row_scale_.data(), padded_rows_, padded_cols_};
  }

 private:
  int padded_rows_;
  int padded_cols_;
  AlignedFloats row_scale_;
  AlignedArray<std::int16_t> data_;
};

}  // namespace patella::network
