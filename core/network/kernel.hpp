// The arithmetic of the network on padded, aligned arrays. One source is compiled for several instruction
// sets, and a table of functions chooses among them at run time. Sums are taken in an order fixed by the
// source, without fused multiply-add: every variant, on every machine, gives the same bits.
//
// Nothing here is inline and nothing is from Eigen: code compiled for a wider instruction set must not leave
// a function behind that the linker could take for everybody's.
#pragma once

#include <cstdint>

namespace patella::network::kernel {

/// Rows that the kernel treats together; every padded length is a multiple of it.
inline constexpr int kPanel = 32;
/// LSTM units in a panel: their rows are i, f, g, o of kUnits each.
inline constexpr int kUnits = kPanel / 4;
/// Floats in a vector of the attention.
inline constexpr int kHeadLanes = 8;
/// Multiple of floats to which the attention's scratch is padded.
inline constexpr int kWeightPadding = 2 * kPanel;
/// The number 1 as a 16-bit activation. Signals of int16 products lie within [-1, 1].
inline constexpr int kInt16One = 1 << 14;
/// Columns whose int16 products are summed in 32 bits before they join the total in float.
inline constexpr int kInt16Block = 32;

/// Panels of kPanel rows, each panel column after column.
struct FloatMatrix {
  const float* data;
  int padded_rows;
  int cols;
};

/// Panels of kPanel rows; in a panel, pairs of columns, and in a pair row after row both columns.
struct Int16Matrix {
  const std::int16_t* data;
  const float* row_scale;  ///< weight = data * row_scale * kInt16One
  int padded_rows;
  int padded_cols;  ///< even
};

/// How heads and time share a vector of kHeadLanes: lane l of block b is head l % heads at step
/// b * steps + l / heads. More than kHeadLanes heads form groups. Where the number of heads is no power of
/// two, those added have queries, keys and values of zero.
struct HeadLayout {
  int groups;         ///< of heads
  int heads;          ///< in a group, padded: 1, 2, 4 or 8
  int steps;          ///< in a block: kHeadLanes / heads
  int head_channels;  ///< of a query or a key
  int outputs;        ///< of the folded value
  int blocks;         ///< that the ring holds
  int query_rows;     ///< groups * head_channels * heads: numbers in a query or a key
};

/// Operands of attend().
struct AttentionView {
  HeadLayout layout;
  const float* newest;  ///< query (scaled), key, value of this step; each group, channel or output, head
  float* keys;          ///< group, block, channel, lane
  float* values;        ///< group, block, output, lane
  float* query;         ///< scratch, head_channels * kHeadLanes
  float* weights;       ///< scratch, blocks * kHeadLanes, padded to kWeightPadding
  int slot;             ///< in the ring, where the newest step goes
  int count;            ///< steps that take part, from the start of the ring, the newest included
};

/// W x. x has as many elements as W has columns, those of int16 in units of 1 / kInt16One.
struct FloatTerm {
  FloatMatrix matrix;
  const float* x;
};
struct Int16Term {
  Int16Matrix matrix;
  const std::int16_t* x;
};

/// y = start + W x; all have padded_rows elements. start may be y.
template <typename Term>
using Product = void(const Term& term, const float* start, float* y) noexcept;
/// y = tanh(start + the sum of the terms), `rows` elements; the same bits as the terms one by one. The tanh's
/// relative error is below 3e-7; it saturates at 1. start may be y.
template <typename... Terms>
using TanhOfSum = void(const Terms&... terms, int rows, const float* start, float* y) noexcept;

struct Functions {
  Product<FloatTerm>* product;
  Product<Int16Term>* product_int16;
  TanhOfSum<FloatTerm>* tanh_of;
  TanhOfSum<Int16Term>* tanh_of_int16;
  TanhOfSum<FloatTerm, FloatTerm>* tanh_of_both;
  TanhOfSum<Int16Term, FloatTerm>* tanh_of_both_mixed;
  TanhOfSum<Int16Term, Int16Term>* tanh_of_both_int16;

  /// y = x kInt16One, rounded; |x| <= 1, `size` a multiple of kPanel. Returns 0, or NaN where an x is not
  /// finite.
  float (*quantise)(const float* x, int size, std::int16_t* y) noexcept;

  /// One LSTM step for `units` units, a multiple of kUnits; cell and hidden are padded to kPanel. `gates`
  /// holds panels of i, f, g, o after the tanh, those of i, f, o as tanh(x/2), because sigmoid(x) = 1/2 + 1/2
  /// tanh(x/2).
  void (*lstm_cell)(const float* gates, int units, float* cell, float* hidden) noexcept;

  /// Puts the newest key and value into the ring, then result[o] += the sum over heads of the
  /// softmax-weighted mean of the values: (32), (33), (34).
  void (*attend)(const AttentionView& view, double* result) noexcept;
};

}  // namespace patella::network::kernel
