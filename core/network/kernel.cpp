#include "core/network/kernel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace patella::network::kernel {

namespace {

/// Columns summed before they join the total: rounding errors then grow with 16 + n/16 instead of n.
constexpr int kColumnBlock = 16;

/// Cephes expf, relative error 2e-7, without branches. Arguments below -87 give exp(-87), not a subnormal.
inline float expOf(float argument) noexcept {
  constexpr float kLog2e = 1.44269504088896341F;
  constexpr float kLn2High = 0.693359375F;
  constexpr float kLn2Low = -2.12194440e-4F;
  // Adding 1.5 * 2^23 rounds to an integer and leaves it in the low bits.
  constexpr float kRound = 12582912.0F;
  const float lower = argument < -87.0F ? -87.0F : argument;
  const float x = 88.0F < lower ? 88.0F : lower;
  const float shifted = x * kLog2e + kRound;
  const float exponent = shifted - kRound;
  const float r = (x - exponent * kLn2High) - exponent * kLn2Low;
  float p = 1.9875691500e-4F;
  p = p * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  const std::uint32_t power =
      (std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(kRound) + 127U) << 23U;
  return (p * r * r + r + 1.0F) * std::bit_cast<float>(power);
}

/// Cephes tanhf with both ranges computed and one chosen. NaN stays NaN.
inline float tanhOf(float x) noexcept {
  const float magnitude = std::fabs(x);
  const float a = 10.0F < magnitude ? 10.0F : magnitude;
  const float z = a * a;
  float p = -5.70498872745e-3F;
  p = p * z + 2.06390887954e-2F;
  p = p * z - 5.37397155531e-2F;
  p = p * z + 1.33314422036e-1F;
  p = p * z - 3.33332819422e-1F;
  const float small = p * z * a + a;
  const float large = 1.0F - 2.0F / (expOf(2.0F * a) + 1.0F);
  return std::copysign(a < 0.625F ? small : large, x);
}

/// Lanes that remain while a panel is reduced: as many as the narrowest vector unit has.
constexpr int kNarrow = 4;

inline float sumOf(const float* lanes) noexcept {
  float sum[kNarrow] = {};
  for (int start = 0; start < kPanel; start += kNarrow)
    for (int lane = 0; lane < kNarrow; ++lane)
      sum[lane] += lanes[start + lane];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

inline float largestOf(const float* lanes) noexcept {
  float largest[kNarrow];
  std::copy_n(lanes, kNarrow, largest);
  for (int start = kNarrow; start < kPanel; start += kNarrow)
    for (int lane = 0; lane < kNarrow; ++lane)
      largest[lane] = lanes[start + lane] < largest[lane] ? largest[lane] : lanes[start + lane];
  return std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
}

/// Scores of one head over the filled steps, (32), into view.weights; returns the largest.
float scoresOf(const AttentionView& view, int head, int padded_count) noexcept {
  const float* query = view.query + head * view.head_channels;
  const float* keys = view.keys + head * view.head_channels * view.stride;
  float largest[kPanel];
  std::fill_n(largest, kPanel, std::numeric_limits<float>::lowest());
  for (int start = 0; start < padded_count; start += kPanel) {
    float score[kPanel] = {};
    for (int channel = 0; channel < view.head_channels; ++channel) {
      const float q = query[channel];
      const float* key = keys + channel * view.stride + start;
      for (int lane = 0; lane < kPanel; ++lane)
        score[lane] += q * key[lane];
    }
    // A step that is not there yet gets a weight that vanishes beside the largest one, which is 1.
    for (int lane = view.count - start; lane < kPanel; ++lane)
      score[lane] = std::numeric_limits<float>::lowest();
    for (int lane = 0; lane < kPanel; ++lane) {
      largest[lane] = score[lane] < largest[lane] ? largest[lane] : score[lane];
      view.weights[start + lane] = score[lane];
    }
  }
  return largestOf(largest);
}

}  // namespace

void addProduct(const PackedMatrix& matrix, const float* __restrict x, float* __restrict y) noexcept {
  const float* __restrict weight = matrix.data();
  const int cols = matrix.cols();
  for (int panel = 0; panel < matrix.paddedRows(); panel += kPanel) {
    for (int first = 0; first < cols; first += kColumnBlock) {
      const int last = std::min(first + kColumnBlock, cols);
      float sum[kPanel] = {};
      for (int col = first; col < last; ++col) {
        const float value = x[col];
        for (int row = 0; row < kPanel; ++row)
          sum[row] += weight[row] * value;
        weight += kPanel;
      }
      for (int row = 0; row < kPanel; ++row)
        y[panel + row] += sum[row];
    }
  }
}

void tanhInPlace(float* x, int size) noexcept {
  for (int start = 0; start < size; start += kPanel)
    for (int lane = 0; lane < kPanel; ++lane)
      x[start + lane] = tanhOf(x[start + lane]);
}

void lstmCell(const float* __restrict gates, int units, float* __restrict cell,
              float* __restrict hidden) noexcept {
  for (int unit = 0; unit < units; unit += kUnits) {
    float gate[kPanel];
    for (int row = 0; row < kPanel; ++row)
      gate[row] = tanhOf(gates[4 * unit + row]);
    for (int lane = 0; lane < kUnits; ++lane) {
      const float input = 0.5F + 0.5F * gate[lane];
      const float forget = 0.5F + 0.5F * gate[kUnits + lane];
      const float output = 0.5F + 0.5F * gate[3 * kUnits + lane];
      const float next = forget * cell[unit + lane] + input * gate[2 * kUnits + lane];
      cell[unit + lane] = next;
      hidden[unit + lane] = output * tanhOf(next);
    }
  }
}

void attend(const AttentionView& view, double* result) noexcept {
  const int padded_count = roundUpToPanel(view.count);
  for (int head = 0; head < view.heads; ++head) {
    const float largest = scoresOf(view, head, padded_count);
    float total[kPanel] = {};
    for (int start = 0; start < padded_count; start += kPanel)
      for (int lane = 0; lane < kPanel; ++lane) {
        const float weight = expOf(view.weights[start + lane] - largest);
        view.weights[start + lane] = weight;
        total[lane] += weight;
      }
    const double normaliser = 1.0 / static_cast<double>(sumOf(total));
    for (int output = 0; output < view.outputs; ++output) {
      const float* values = view.values + (head * view.outputs + output) * view.stride;
      float weighted[kPanel] = {};
      for (int start = 0; start < padded_count; start += kPanel)
        for (int lane = 0; lane < kPanel; ++lane)
          weighted[lane] += view.weights[start + lane] * values[start + lane];
      result[output] += static_cast<double>(sumOf(weighted)) * normaliser;
    }
  }
}

}  // namespace patella::network::kernel
