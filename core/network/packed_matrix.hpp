// Flat, aligned storage in the order in which the kernel reads it.
#pragma once

#include <memory>
#include <new>

#include <Eigen/Core>

namespace patella::network {

/// Rows that the kernel treats together; every padded length is a multiple of it.
inline constexpr int kPanel = 32;

constexpr int roundUpToPanel(int count) noexcept {
  return (count + kPanel - 1) / kPanel * kPanel;
}

/// Zeroed floats that begin on a cache line.
class AlignedFloats {
 public:
  explicit AlignedFloats(int size);

  float* data() noexcept { return data_.get(); }
  const float* data() const noexcept { return data_.get(); }
  int size() const noexcept { return size_; }
  void setZero() noexcept;

 private:
  static constexpr std::align_val_t kCacheLine{64};
  struct Free {
    void operator()(float* data) const noexcept { ::operator delete[](data, kCacheLine); }
  };
  std::unique_ptr<float[], Free> data_;
  int size_;
};

/// A matrix in panels of kPanel rows, each panel column after column: a product reads it once, front to back.
/// Missing rows of the last panel are zero.
class PackedMatrix {
 public:
  /// Rounds to float; throws std::invalid_argument where an element is beyond its range.
  explicit PackedMatrix(const Eigen::MatrixXd& matrix);

  int paddedRows() const noexcept { return padded_rows_; }
  int cols() const noexcept { return cols_; }
  const float* data() const noexcept { return data_.data(); }

 private:
  int padded_rows_;
  int cols_;
  AlignedFloats data_;
};

}  // namespace patella::network
