// The arithmetic of the network on padded, aligned arrays: plain loops of fixed length that any compiler
// turns into vector code, without Eigen, so that one source can be compiled for several instruction sets.
// Sums are taken in an order fixed by the source, hence the same on every machine.
#pragma once

#include "core/network/packed_matrix.hpp"

namespace patella::network::kernel {

/// LSTM units in a panel: their rows are i, f, g, o of kUnits each.
inline constexpr int kUnits = kPanel / 4;

/// y += W x. x has W.cols() elements, y W.paddedRows().
void addProduct(const PackedMatrix& matrix, const float* x, float* y) noexcept;

/// x = tanh(x), absolute error below 1e-7. `size` is a multiple of kPanel.
void tanhInPlace(float* x, int size) noexcept;

/// One LSTM step for `units` units, a multiple of kUnits. `gates` holds the sums before the nonlinearities in
/// panels of i, f, g, o, those of i, f, o halved, because sigmoid(x) = 1/2 + 1/2 tanh(x/2).
void lstmCell(const float* gates, int units, float* cell, float* hidden) noexcept;

/// What attend() reads. Time runs along the rows of length `stride`, a multiple of kPanel.
struct AttentionView {
  const float* query;   ///< heads * head_channels, scaled
  const float* keys;    ///< (heads * head_channels) x stride
  const float* values;  ///< (heads * outputs) x stride
  float* weights;       ///< scratch, stride
  int heads;
  int head_channels;
  int outputs;
  int stride;
  int count;  ///< steps that are filled, from the start of each row; what follows them is zero
};

/// result[o] += sum over heads of the softmax-weighted mean of the values: (32), (33), (34).
void attend(const AttentionView& view, double* result) noexcept;

}  // namespace patella::network::kernel
