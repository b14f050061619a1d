// The attention, eight heads side by side.
#pragma once

#include "core/network/kernel_vectors.hpp"

namespace patella::network::kernel {

template <typename Isa>
struct KernelAttention : KernelVectors<Isa> {
  using Base = KernelVectors<Isa>;
  using Base::kAtOnce;
  using Base::kLanes;
  using Base::kSumBlock;
  using Base::kUnitLanes;
  using typename Base::Float;
  using typename Base::Unit;
  static constexpr int kPieces = kHeadLanes / kUnitLanes;
  static constexpr int kMaxOutputs = 2;
  static constexpr int kBlocksAtOnce = kLanes == 16 ? 4 : 2;  ///< whose scores share the load of a query
  /// A score that leaves a weight of nothing beside the largest one, which is 1.
  static constexpr float kNever = -3.4e38F;

  /// The attention's vector of kHeadLanes floats, in as many pieces as the instruction set needs.
  struct Heads {
    Unit piece[kPieces];
  };

  PATELLA_KERNEL Heads loadHeads(const float* from) noexcept {
    Heads heads;
    for (int i = 0; i < kPieces; ++i)
      heads.piece[i] = Base::template load<Unit>(from + i * kUnitLanes);
    return heads;
  }

  PATELLA_KERNEL void storeHeads(float* to, const Heads& heads) noexcept {
    for (int i = 0; i < kPieces; ++i)
      Base::store(to + i * kUnitLanes, heads.piece[i]);
  }

  /// total += a b
  PATELLA_KERNEL void addProductOf(Heads& total, const Heads& a, const Heads& b) noexcept {
    for (int i = 0; i < kPieces; ++i)
      total.piece[i] += a.piece[i] * b.piece[i];
  }

  PATELLA_KERNEL void add(Heads& total, const Heads& a) noexcept {
    for (int i = 0; i < kPieces; ++i)
      total.piece[i] += a.piece[i];
  }

  /// The heads of the newest step into its lanes of the ring, and the query into the lanes of every step.
  PATELLA_KERNEL void spread(const AttentionView& view, int group) noexcept {
    const HeadLayout& layout = view.layout;
    const int lane = view.slot % layout.steps * layout.heads;
    const int block = group * layout.blocks + view.slot / layout.steps;
    const float* query = view.newest + group * layout.head_channels * layout.heads;
    const float* key = query + layout.query_rows;
    const float* value = view.newest + 2 * layout.query_rows + group * layout.outputs * layout.heads;
    float* keys = view.keys + block * layout.head_channels * kHeadLanes + lane;
    float* values = view.values + block * layout.outputs * kHeadLanes + lane;
    for (int channel = 0; channel < layout.head_channels; ++channel)
      for (int head = 0; head < layout.heads; ++head) {
        const int from = channel * layout.heads + head;
        const int to = channel * kHeadLanes + head;
        keys[to] = key[from];
        for (int step = 0; step < layout.steps; ++step)
          view.query[to + step * layout.heads] = query[from];
      }
    for (int output = 0; output < layout.outputs; ++output)
      for (int head = 0; head < layout.heads; ++head)
        values[output * kHeadLanes + head] = value[output * layout.heads + head];
  }

  /// The same where a vector is one step of eight heads.
  PATELLA_KERNEL void spreadWhole(const AttentionView& view, int group) noexcept {
    const HeadLayout& layout = view.layout;
    const int block = group * layout.blocks + view.slot;
    const float* query = view.newest + group * layout.head_channels * kHeadLanes;
    const float* value = view.newest + 2 * layout.query_rows + group * layout.outputs * kHeadLanes;
    float* keys = view.keys + block * layout.head_channels * kHeadLanes;
    float* values = view.values + block * layout.outputs * kHeadLanes;
    for (int at = 0; at < layout.head_channels * kHeadLanes; at += kHeadLanes) {
      storeHeads(view.query + at, loadHeads(query + at));
      storeHeads(keys + at, loadHeads(query + layout.query_rows + at));
    }
    for (int at = 0; at < layout.outputs * kHeadLanes; at += kHeadLanes)
      storeHeads(values + at, loadHeads(value + at));
  }

  /// Scores (32) of kStride blocks, that many at once to load a query once for all.
  template <int kStride>
  PATELLA_KERNEL void scoreBlocks(const AttentionView& view, const float* keys, int block,
                                  Heads& largest) noexcept {
    const int channels = view.layout.head_channels;
    const float* key = keys + block * channels * kHeadLanes;
    Heads score[kStride] = {};
    for (int channel = 0; channel < channels; ++channel) {
      const Heads query = loadHeads(view.query + channel * kHeadLanes);
      for (int i = 0; i < kStride; ++i)
        addProductOf(score[i], loadHeads(key + (i * channels + channel) * kHeadLanes), query);
    }
    for (int i = 0; i < kStride; ++i) {
      storeHeads(view.weights + (block + i) * kHeadLanes, score[i]);
      for (int j = 0; j < kPieces; ++j)
        largest.piece[j] = Base::larger(largest.piece[j], score[i].piece[j]);
    }
  }

  /// Folds the lanes of one head's steps together, so that each lane has its head's result.
  template <typename Fold>
  PATELLA_KERNEL void foldSteps(Heads& heads, int lanes_per_step, Fold fold) noexcept {
    alignas(64) float lane[kHeadLanes];
    for (int shift = lanes_per_step; shift < kHeadLanes; shift *= 2) {
      storeHeads(lane, heads);
      alignas(64) float folded[kHeadLanes];
      for (int i = 0; i < kHeadLanes; ++i)
        folded[i] = fold(lane[i], lane[i ^ shift]);
      heads = loadHeads(folded);
    }
  }

  /// The largest score of every lane, after all scores went into view.weights.
  PATELLA_KERNEL Heads scoreAll(const AttentionView& view, const float* keys) noexcept {
    Heads largest;
    for (int i = 0; i < kPieces; ++i)
      largest.piece[i] = Base::template splat<Unit>(kNever);
    const int full = view.count / view.layout.steps;
    int block = 0;
    for (; block + kBlocksAtOnce <= full; block += kBlocksAtOnce)
      scoreBlocks<kBlocksAtOnce>(view, keys, block, largest);
    for (; block < full; ++block)
      scoreBlocks<1>(view, keys, block, largest);
    const int rest = view.count % view.layout.steps;
    if (rest > 0) {
      // The last block's missing steps must not count as scores.
      Heads unused = largest;
      scoreBlocks<1>(view, keys, block, unused);
      float* const scores = view.weights + block * kHeadLanes;
      for (int lane = rest * view.layout.heads; lane < kHeadLanes; ++lane)
        scores[lane] = kNever;
      const Heads last = loadHeads(scores);
      for (int i = 0; i < kPieces; ++i)
        largest.piece[i] = Base::larger(largest.piece[i], last.piece[i]);
    }
    foldSteps(largest, view.layout.heads, [](float a, float b) { return a < b ? b : a; });
    return largest;
  }

  /// Scores into weights (33) before normalisation, all lanes of all blocks. `blocks` is padded to kAtOnce
  /// vectors by the scratch's size; what is computed too much is not used.
  PATELLA_KERNEL void weightsOf(float* scores, int blocks, const Heads& largest) noexcept {
    alignas(64) float repeated[kLanes > kHeadLanes ? kLanes : kHeadLanes];
    for (int lane = 0; lane < kLanes; lane += kHeadLanes)
      storeHeads(repeated + lane, largest);
    constexpr int kRepeat = kLanes < kHeadLanes ? kHeadLanes / kLanes : 1;
    for (int start = 0; start < blocks * kHeadLanes; start += kAtOnce * kLanes) {
      Float x[kAtOnce];
      Base::template forEach<kAtOnce>([&](int i) {
        const Float offset = Base::template load<Float>(repeated + i % kRepeat * kLanes);
        x[i] = Base::larger(Base::template load<Float>(scores + start + i * kLanes) - offset,
                            Base::splat(-87.0F));
      });
      Base::expInPlace(x);
      Base::template forEach<kAtOnce>([&](int i) { Base::store(scores + start + i * kLanes, x[i]); });
    }
  }

  /// The sum of the weights and the weighted sums of the values, (34) before normalisation.
  PATELLA_KERNEL void weigh(const AttentionView& view, const float* values, int blocks, Heads& total,
                            Heads (&weighted)[kMaxOutputs]) noexcept {
    const int outputs = view.layout.outputs;
    for (int first = 0; first < blocks; first += kSumBlock) {
      const int last = first + kSumBlock < blocks ? first + kSumBlock : blocks;
      Heads part_of_total = {};
      Heads part[kMaxOutputs] = {};
      for (int block = first; block < last; ++block) {
        const Heads weight = loadHeads(view.weights + block * kHeadLanes);
        const float* value = values + block * outputs * kHeadLanes;
        add(part_of_total, weight);
        addProductOf(part[0], weight, loadHeads(value));
        if (outputs > 1)
          addProductOf(part[1], weight, loadHeads(value + kHeadLanes));
      }
      add(total, part_of_total);
      for (int output = 0; output < kMaxOutputs; ++output)
        add(weighted[output], part[output]);
    }
  }

  static void attend(const AttentionView& view, double* result) noexcept {
    const HeadLayout& layout = view.layout;
    const auto sum = [](float a, float b) { return a + b; };
    for (int group = 0; group < layout.groups; ++group) {
      if (layout.steps == 1)
        spreadWhole(view, group);
      else
        spread(view, group);
      const int first_block = group * layout.blocks;
      const Heads largest = scoreAll(view, view.keys + first_block * layout.head_channels * kHeadLanes);
      const int blocks = (view.count + layout.steps - 1) / layout.steps;
      weightsOf(view.weights, blocks, largest);
      Heads total = {};
      Heads weighted[kMaxOutputs] = {};
      weigh(view, view.values + first_block * layout.outputs * kHeadLanes, blocks, total, weighted);
      foldSteps(total, layout.heads, sum);
      for (int output = 0; output < layout.outputs; ++output) {
        foldSteps(weighted[output], layout.heads, sum);
        alignas(64) float mean[kHeadLanes];
        for (int i = 0; i < kPieces; ++i)
          Base::store(mean + i * kUnitLanes, weighted[output].piece[i] / total.piece[i]);
        for (int head = 0; head < layout.heads; ++head)
          result[output] += static_cast<double>(mean[head]);
      }
    }
  }
};

}  // namespace patella::network::kernel
