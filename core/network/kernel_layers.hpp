// Products, rounding and the LSTM's cell.
#pragma once

#include "core/network/kernel_vectors.hpp"

namespace patella::network::kernel {

template <typename Isa>
struct KernelLayers : KernelVectors<Isa> {
  using Base = KernelVectors<Isa>;
  using Base::kLanes;
  using Base::kSumBlock;
  using Base::kUnitLanes;
  using Base::kVectors;
  using typename Base::Bits;
  using typename Base::Float;
  using typename Base::Int;
  using typename Base::Short;
  using typename Base::Unit;

  /// total += the panel's rows of W x.
  PATELLA_KERNEL void addPanel(const FloatTerm& term, int panel, Float (&total)[kVectors]) noexcept {
    const int cols = term.matrix.cols;
    const float* __restrict x = term.x;
    const float* __restrict weight = term.matrix.data + panel * cols;
    for (int first = 0; first < cols; first += kSumBlock) {
      const int last = first + kSumBlock < cols ? first + kSumBlock : cols;
      Float sum[kVectors] = {};
      for (int col = first; col < last; ++col) {
        Base::template forEach<kVectors>(
            [&](int i) { sum[i] += Base::template load<Float>(weight + i * kLanes) * x[col]; });
        weight += kPanel;
      }
      Base::template forEach<kVectors>([&](int i) { total[i] += sum[i]; });
    }
  }

  PATELLA_KERNEL void addPanel(const Int16Term& term, int panel, Float (&total)[kVectors]) noexcept {
    const int cols = term.matrix.padded_cols;
    const std::int16_t* __restrict x = term.x;
    const std::int16_t* __restrict weight = term.matrix.data + panel * cols;
    Float all[kVectors] = {};
    for (int first = 0; first < cols; first += kInt16Block) {
      const int last = first + kInt16Block < cols ? first + kInt16Block : cols;
      Int sum[kVectors] = {};
      for (int col = first; col < last; col += 2) {
        std::int32_t pair;
        __builtin_memcpy(&pair, x + col, sizeof(pair));
        const Short both = reinterpret_cast<Short>(pair - Int{});
        Base::template forEach<kVectors>([&](int i) {
          sum[i] += Isa::multiplyPairs(Base::template load<Short>(weight + 2 * i * kLanes), both);
        });
        weight += 2 * kPanel;
      }
      Base::template forEach<kVectors>([&](int i) { all[i] += __builtin_convertvector(sum[i], Float); });
    }
    Base::template forEach<kVectors>([&](int i) {
      total[i] += all[i] * Base::template load<Float>(term.matrix.row_scale + panel + i * kLanes);
    });
  }

  template <typename Term>
  static void product(const Term& term, const float* start, float* y) noexcept {
    for (int panel = 0; panel < term.matrix.padded_rows; panel += kPanel) {
      Float total[kVectors];
      Base::template forEach<kVectors>(
          [&](int i) { total[i] = Base::template load<Float>(start + panel + i * kLanes); });
      addPanel(term, panel, total);
      Base::template forEach<kVectors>([&](int i) { Base::store(y + panel + i * kLanes, total[i]); });
    }
  }

  template <typename... Terms>
  static void tanhOfSum(const Terms&... terms, int rows, const float* start, float* y) noexcept {
    for (int panel = 0; panel < rows; panel += kPanel) {
      Float total[kVectors];
      Base::template forEach<kVectors>(
          [&](int i) { total[i] = Base::template load<Float>(start + panel + i * kLanes); });
      (addPanel(terms, panel, total), ...);
      Base::tanhOfPanel(total);
      Base::template forEach<kVectors>([&](int i) { Base::store(y + panel + i * kLanes, total[i]); });
    }
  }

  static float quantise(const float* __restrict x, int size, std::int16_t* __restrict y) noexcept {
    Float poison = {};
    for (int start = 0; start < size; start += kLanes) {
      const Float value = Base::template load<Float>(x + start);
      poison += value * 0.0F;
      const Bits rounded = reinterpret_cast<Bits>(value * static_cast<float>(kInt16One) + Base::kRound);
      for (int lane = 0; lane < kLanes; ++lane)
        y[start + lane] = static_cast<std::int16_t>(rounded[lane]);
    }
    float sum = 0.0F;
    for (int lane = 0; lane < kLanes; ++lane)
      sum += poison[lane];
    return sum;
  }

  static void lstmCell(const float* __restrict gates, int units, float* __restrict cell,
                       float* __restrict hidden) noexcept {
    for (int unit = 0; unit < units; unit += kUnitLanes) {
      const float* gate = gates + unit / kUnits * kPanel + unit % kUnits;
      const Unit input = Base::template load<Unit>(gate) * 0.5F + 0.5F;
      const Unit forget = Base::template load<Unit>(gate + kUnits) * 0.5F + 0.5F;
      Base::store(cell + unit, forget * Base::template load<Unit>(cell + unit) +
                                   input * Base::template load<Unit>(gate + 2 * kUnits));
    }
    for (int start = 0; start < units; start += kPanel) {
      Float panel[kVectors];
      Base::template forEach<kVectors>(
          [&](int i) { panel[i] = Base::template load<Float>(cell + start + i * kLanes); });
      Base::tanhOfPanel(panel);
      Base::template forEach<kVectors>([&](int i) { Base::store(hidden + start + i * kLanes, panel[i]); });
    }
    for (int unit = 0; unit < units; unit += kUnitLanes) {
      const float* gate = gates + unit / kUnits * kPanel + unit % kUnits;
      const Unit output = Base::template load<Unit>(gate + 3 * kUnits) * 0.5F + 0.5F;
      Base::store(hidden + unit, output * Base::template load<Unit>(hidden + unit));
    }
  }
};

}  // namespace patella::network::kernel
