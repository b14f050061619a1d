// The attention-LSTM's numbers as PyTorch lays them out, with what is needed to use them: features, units,
// normalisation, rate. Only data; AttentionLstm arranges them for speed.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/bounds/bounds.hpp"

namespace patella::network {

inline constexpr int kMaxLstmLayers = 2;
/// Bounds the ring of keys and values that a weights file may ask for.
inline constexpr int kMaxWindow = static_cast<int>(boundOf("window").maximum);
inline constexpr int kMaxWidth = 4096;  ///< of any layer
inline constexpr int kMaxLinearLags = 64;

using WeightMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using WeightVector = Eigen::VectorXf;

/// torch.nn.LSTM, one layer. Rows are the gates i, f, g, o, each H rows.
struct LstmWeights {
  WeightMatrix weight_ih;  ///< 4H x inputs of the layer
  WeightMatrix weight_hh;  ///< 4H x H
  WeightVector bias_ih;    ///< 4H
  WeightVector bias_hh;    ///< 4H
};

/// Factor of the scores of (32) before the softmax (33).
enum class AttentionScale {
  kInvSqrt,  ///< 1/sqrt(D / heads), PyTorch's
  kNone      ///< 1, as the paper prints it
};

/// Meaning of the outputs, one per joint.
enum class OutputKind {
  kAcceleration,            ///< f_u, rad/s²
  kTorque,                  ///< d = I f_u, N·m
  kAccelerationCorrection,  ///< to be added to an observer's f_u, rad/s²
  kTorqueCorrection         ///< to be added to an observer's d, N·m
};

struct NetworkWeights {
  std::vector<LstmWeights> lstm;  ///< one or two layers
  WeightMatrix fc_weight;         ///< D x H
  WeightVector fc_bias;           ///< D
  WeightMatrix in_proj_weight;    ///< 3D x D: W_q, W_k, W_v of (31) one below the other
  WeightVector in_proj_bias;      ///< 3D
  WeightMatrix out_proj_weight;   ///< D x D
  WeightVector out_proj_bias;     ///< D
  WeightMatrix output_weight;     ///< outputs x D
  WeightVector output_bias;       ///< outputs
  /// outputs x (lags * inputs), lag after lag: acts beside LSTM and attention on the normalised features of
  /// now and of some steps ago, and is added to the output. No elements where there are no lags.
  WeightMatrix linear_weight;
  /// outputs, positive, in units of output_scale: as far as that sum may go, see LinearHistory. No elements
  /// where there are no lags.
  WeightVector linear_bound;
  std::vector<int> linear_lags;  ///< steps, ascending from 0, below kMaxWindow; empty: no linear path
  int heads = 8;                 ///< divides D
  int window = 64;               ///< steps the newest query sees, itself included
  AttentionScale attention_scale = AttentionScale::kInvSqrt;

  std::vector<std::string> features;  ///< names with units, in the order of the inputs
  Eigen::VectorXd feature_mean;       ///< the network sees (feature - mean) / scale
  Eigen::VectorXd feature_scale;
  Eigen::VectorXd output_mean;  ///< delivered is output * scale + mean
  Eigen::VectorXd output_scale;
  double rate_Hz = 1000.0;  ///< steps a second at which the network was trained
  OutputKind output = OutputKind::kAcceleration;
};

/// The sizes from which every tensor's shape follows.
struct NetworkShape {
  Eigen::Index inputs = 0;
  Eigen::Index hidden = 0;
  Eigen::Index layers = 0;
  Eigen::Index channels = 0;
  Eigen::Index outputs = 0;
};

/// As the features, weight_hh of the first layer, fc_weight and output_weight have it; nothing is checked.
NetworkShape shapeOf(const NetworkWeights& weights) noexcept;

/// Throws std::invalid_argument naming what is wrong with linear_lags, unless they are as NetworkWeights
/// says.
void checkLinearLags(const std::vector<int>& lags);

/// Throws std::invalid_argument naming the tensor or the quantity, what was found and what was expected,
/// unless all sizes fit together, all numbers are finite and all scales positive.
void checkWeights(const NetworkWeights& weights);

/// Calls visit(name, tensor, rows, cols) for every tensor under its PyTorch name, with the shape it must
/// have; vectors have cols = 1. `weights.lstm` must already hold shape.layers elements, and linear_lags what
/// it is to hold.
template <typename Weights, typename Visitor>
void visitTensors(Weights& weights, const NetworkShape& shape, Visitor visit) {
  const auto [inputs, hidden, layers, channels, outputs] = shape;
  for (Eigen::Index layer = 0; layer < layers; ++layer) {
    auto& lstm = weights.lstm[static_cast<std::size_t>(layer)];
    const std::string suffix = "_l" + std::to_string(layer);
    visit("lstm.weight_ih" + suffix, lstm.weight_ih, 4 * hidden, layer == 0 ? inputs : hidden);
    visit("lstm.weight_hh" + suffix, lstm.weight_hh, 4 * hidden, hidden);
    visit("lstm.bias_ih" + suffix, lstm.bias_ih, 4 * hidden, Eigen::Index{1});
    visit("lstm.bias_hh" + suffix, lstm.bias_hh, 4 * hidden, Eigen::Index{1});
  }
  visit(std::string("fc.weight"), weights.fc_weight, channels, hidden);
  visit(std::string("fc.bias"), weights.fc_bias, channels, Eigen::Index{1});
  visit(std::string("attention.in_proj_weight"), weights.in_proj_weight, 3 * channels, channels);
  visit(std::string("attention.in_proj_bias"), weights.in_proj_bias, 3 * channels, Eigen::Index{1});
  visit(std::string("attention.out_proj.weight"), weights.out_proj_weight, channels, channels);
  visit(std::string("attention.out_proj.bias"), weights.out_proj_bias, channels, Eigen::Index{1});
  visit(std::string("output.weight"), weights.output_weight, outputs, channels);
  visit(std::string("output.bias"), weights.output_bias, outputs, Eigen::Index{1});
  if (!weights.linear_lags.empty()) {
    visit(std::string("linear.weight"), weights.linear_weight, outputs,
          static_cast<Eigen::Index>(weights.linear_lags.size()) * inputs);
    visit(std::string("linear.bound"), weights.linear_bound, outputs, Eigen::Index{1});
  }
}

}  // namespace patella::network
