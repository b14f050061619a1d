#include "tests/unit/network/loop_reference.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patella::network {

namespace {

using Vector = std::vector<double>;

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

/// bias + weight x for rows first … first + count - 1.
Vector affine(const WeightMatrix& weight, const WeightVector& bias, const Vector& x, Eigen::Index first,
              Eigen::Index count) {
  Vector y;
  for (Eigen::Index row = first; row < first + count; ++row) {
    double sum = static_cast<double>(bias[row]);
    for (Eigen::Index col = 0; col < weight.cols(); ++col)
      sum += static_cast<double>(weight(row, col)) * x[static_cast<std::size_t>(col)];
    y.push_back(sum);
  }
  return y;
}

Vector affine(const WeightMatrix& weight, const WeightVector& bias, const Vector& x) {
  return affine(weight, bias, x, 0, weight.rows());
}

struct LstmState {
  Vector hidden;
  Vector cell;
};

void lstmStep(const LstmWeights& weights, const Vector& input, LstmState& state) {
  const std::size_t units = state.hidden.size();
  const Vector from_input = affine(weights.weight_ih, weights.bias_ih, input);
  const Vector from_hidden = affine(weights.weight_hh, weights.bias_hh, state.hidden);
  const auto gate = [&](std::size_t which, std::size_t unit) {
    return from_input[which * units + unit] + from_hidden[which * units + unit];
  };
  for (std::size_t unit = 0; unit < units; ++unit) {
    state.cell[unit] =
        sigmoid(gate(1, unit)) * state.cell[unit] + sigmoid(gate(0, unit)) * std::tanh(gate(2, unit));
    state.hidden[unit] = sigmoid(gate(3, unit)) * std::tanh(state.cell[unit]);
  }
}

/// (31) to (34) for the query at `step`, all heads side by side.
Vector context(const NetworkWeights& weights, const std::vector<Vector>& signal, std::size_t step) {
  const Eigen::Index channels = weights.fc_weight.rows();
  const auto head_channels = static_cast<std::size_t>(channels / weights.heads);
  const double scale = weights.attention_scale == AttentionScale::kInvSqrt
                           ? 1.0 / std::sqrt(static_cast<double>(head_channels))
                           : 1.0;
  const auto projected = [&](Eigen::Index which, std::size_t at) {
    return affine(weights.in_proj_weight, weights.in_proj_bias, signal[at], which * channels, channels);
  };
  const auto window = static_cast<std::size_t>(weights.window);
  const std::size_t first = step + 1 > window ? step + 1 - window : 0;
  const Vector query = projected(0, step);
  std::vector<Vector> keys, values;
  for (std::size_t at = first; at <= step; ++at) {
    keys.push_back(projected(1, at));
    values.push_back(projected(2, at));
  }
  Vector result(static_cast<std::size_t>(channels), 0.0);
  for (std::size_t head = 0; head < static_cast<std::size_t>(weights.heads); ++head) {
    Vector weight;
    for (const Vector& key : keys) {
      double score = 0.0;
      for (std::size_t i = head * head_channels; i < (head + 1) * head_channels; ++i)
        score += query[i] * key[i];
      weight.push_back(scale * score);
    }
    const double largest = *std::max_element(weight.begin(), weight.end());
    double total = 0.0;
    for (double& value : weight)
      total += value = std::exp(value - largest);
    for (std::size_t at = 0; at < values.size(); ++at)
      for (std::size_t i = head * head_channels; i < (head + 1) * head_channels; ++i)
        result[i] += weight[at] / total * values[at][i];
  }
  return result;
}

/// Sum of the linear path over the steps so far; the first stands in for those before it.
double linearPath(const NetworkWeights& weights, const std::vector<Vector>& inputs, Eigen::Index output) {
  double sum = 0.0;
  Eigen::Index column = 0;
  for (const int lag : weights.linear_lags)
    for (const double input :
         inputs[inputs.size() - 1 - std::min<std::size_t>(inputs.size() - 1, static_cast<std::size_t>(lag))])
      sum += static_cast<double>(weights.linear_weight(output, column++)) * input;
  return sum;
}

/// In what the linear path says of a step: falls from 1 to 0 between once and twice its bound.
double trustIn(const NetworkWeights& weights, const Vector& linear) {
  double trust = 1.0;
  for (std::size_t i = 0; i < linear.size() && !weights.linear_lags.empty(); ++i) {
    const auto bound = static_cast<double>(weights.linear_bound[static_cast<Eigen::Index>(i)]);
    trust = std::min(trust, std::max(0.0, 2.0 - std::abs(linear[i]) / bound));
  }
  return trust;
}

/// Trust in the newest step. What was lost at a step comes back over as many steps as the longest lag has.
double recovering(const NetworkWeights& weights, const Vector& trusts) {
  double trust = 1.0;
  for (std::size_t age = 0; age < trusts.size() && !weights.linear_lags.empty(); ++age)
    trust = std::min(trust, trusts[trusts.size() - 1 - age] +
                                static_cast<double>(age) / std::max(1, weights.linear_lags.back()));
  return trust;
}

}  // namespace

Eigen::MatrixXd loopReference(const NetworkWeights& weights, const Eigen::MatrixXd& features) {
  const auto units = static_cast<std::size_t>(weights.lstm.front().weight_hh.cols());
  std::vector<LstmState> states(weights.lstm.size(), {Vector(units, 0.0), Vector(units, 0.0)});
  std::vector<Vector> inputs;
  std::vector<Vector> signal;
  Vector trusts;
  Eigen::MatrixXd outputs(features.rows(), weights.output_weight.rows());
  for (Eigen::Index step = 0; step < features.rows(); ++step) {
    Vector value;
    for (Eigen::Index i = 0; i < features.cols(); ++i)
      value.push_back((features(step, i) - weights.feature_mean[i]) / weights.feature_scale[i]);
    inputs.push_back(value);
    for (std::size_t layer = 0; layer < weights.lstm.size(); ++layer) {
      lstmStep(weights.lstm[layer], value, states[layer]);
      value = states[layer].hidden;
    }
    value = affine(weights.fc_weight, weights.fc_bias, value);
    for (double& channel : value)
      channel = std::tanh(channel);
    signal.push_back(value);
    const Vector attended = affine(weights.out_proj_weight, weights.out_proj_bias,
                                   context(weights, signal, static_cast<std::size_t>(step)));
    const Vector result = affine(weights.output_weight, weights.output_bias, attended);
    Vector linear;
    for (Eigen::Index i = 0; i < outputs.cols(); ++i)
      linear.push_back(linearPath(weights, inputs, i));
    trusts.push_back(trustIn(weights, linear));
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      outputs(step, joint) =
          (result[i] + recovering(weights, trusts) * linear[i]) * weights.output_scale[joint] +
          weights.output_mean[joint];
    }
  }
  return outputs;
}

}  // namespace patella::network
