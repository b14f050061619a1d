// The network as one would write it down in fixed-size Eigen: no arrangement of the weights, nothing folded.
#include "tools/bench/inference/eigen_peer.hpp"

#include <Eigen/Core>

namespace {

using patella::bench::PeerFunctions;
using patella::bench::PeerWeights;

constexpr int kInputs = 5;
constexpr int kHidden = 128;
constexpr int kChannels = 64;
constexpr int kHeads = 8;
constexpr int kHeadChannels = kChannels / kHeads;
constexpr int kWindow = 64;
constexpr int kOutputs = 2;

template <int Rows>
using Vector = Eigen::Matrix<float, Rows, 1>;

template <int Rows, int Cols>
struct Affine {
  Eigen::Matrix<float, Rows, Cols> weight;
  Vector<Rows> bias;

  void set(const float* rows, const float* biases) {
    weight = Eigen::Map<const Eigen::Matrix<float, Rows, Cols, Eigen::RowMajor>>(rows);
    bias = Eigen::Map<const Vector<Rows>>(biases);
  }
};

struct EigenPeer {
  explicit EigenPeer(const PeerWeights& w) {
    input.set(w.weight_ih, w.bias_ih);
    hidden.set(w.weight_hh, w.bias_hh);
    dense.set(w.fc_weight, w.fc_bias);
    in_proj.set(w.in_proj_weight, w.in_proj_bias);
    out_proj.set(w.out_proj_weight, w.out_proj_bias);
    output.set(w.output_weight, w.output_bias);
    h.setZero();
    c.setZero();
    keys.setZero();
    values.setZero();
  }

  void recurrent(const float* features) {
    const Eigen::Map<const Vector<kInputs>> x(features);
    gates = input.bias + hidden.bias;
    gates.noalias() += input.weight * x;
    gates.noalias() += hidden.weight * h;
    const auto i = gates.segment<kHidden>(0).array().logistic();
    const auto f = gates.segment<kHidden>(kHidden).array().logistic();
    const auto g = gates.segment<kHidden>(2 * kHidden).array().tanh();
    const auto o = gates.segment<kHidden>(3 * kHidden).array().logistic();
    c = (f * c.array() + i * g).matrix();
    h = (o * c.array().tanh()).matrix();
    z = dense.bias;
    z.noalias() += dense.weight * h;
    z = z.array().tanh().matrix();
  }

  float whole(const float* features) {
    recurrent(features);
    projected = in_proj.bias;
    projected.noalias() += in_proj.weight * z;
    keys.col(slot) = projected.segment<kChannels>(kChannels);
    values.col(slot) = projected.segment<kChannels>(2 * kChannels);
    slot = (slot + 1) % kWindow;
    const float scale = 1.0F / std::sqrt(static_cast<float>(kHeadChannels));
    for (int head = 0; head < kHeads; ++head) {
      const int first = head * kHeadChannels;
      Vector<kWindow> weight;
      weight.noalias() =
          keys.middleRows<kHeadChannels>(first).transpose() * projected.segment<kHeadChannels>(first);
      weight = ((weight.array() - weight.maxCoeff()) * scale).exp().matrix();
      context.segment<kHeadChannels>(first).noalias() =
          values.middleRows<kHeadChannels>(first) * weight / weight.sum();
    }
    attended = out_proj.bias;
    attended.noalias() += out_proj.weight * context;
    Vector<kOutputs> y = output.bias;
    y.noalias() += output.weight * attended;
    return y[0];
  }

  Affine<4 * kHidden, kInputs> input;
  Affine<4 * kHidden, kHidden> hidden;
  Affine<kChannels, kHidden> dense;
  Affine<3 * kChannels, kChannels> in_proj;
  Affine<kChannels, kChannels> out_proj;
  Affine<kOutputs, kChannels> output;
  Vector<4 * kHidden> gates;
  Vector<kHidden> h;
  Vector<kHidden> c;
  Vector<kChannels> z;
  Vector<3 * kChannels> projected;
  Vector<kChannels> context;
  Vector<kChannels> attended;
  Eigen::Matrix<float, kChannels, kWindow> keys;
  Eigen::Matrix<float, kChannels, kWindow> values;
  int slot = 0;
};

}  // namespace

extern "C" [[gnu::visibility("default")]] constexpr PeerFunctions PATELLA_PEER = {
    .make = [](const PeerWeights& weights) -> void* { return new EigenPeer(weights); },
    .destroy = [](void* peer) { delete static_cast<EigenPeer*>(peer); },
    .whole = [](void* peer, const float* features) { return static_cast<EigenPeer*>(peer)->whole(features); },
    .recurrent =
        [](void* peer, const float* features) {
          static_cast<EigenPeer*>(peer)->recurrent(features);
          return static_cast<EigenPeer*>(peer)->z[0];
        }};
