#include "core/network/attention_lstm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace patella::network {

namespace {

const NetworkWeights& checked(const NetworkWeights& weights) {
  checkWeights(weights);
  return weights;
}

Precision checkedPrecision(const NetworkWeights& weights, const InferenceOptions& options) {
  if (options.precision == Precision::kInt16) {
    const double error = AttentionLstm::int16Error(weights);
    if (!(error <= options.int16_tolerance)) {
      std::ostringstream message;
      message << "precision 'int16': outputs differ from float32 by " << error
              << " of output_scale, expected at most " << options.int16_tolerance;
      throw std::invalid_argument(message.str());
    }
  }
  return options.precision;
}

}  // namespace

AttentionLstm::AttentionLstm(const NetworkWeights& weights, const InferenceOptions& options)
    : AttentionLstm(weights, checkedPrecision(checked(weights), options),
                    kernel::functionsFor(options.instruction_set)) {}

AttentionLstm::AttentionLstm(const NetworkWeights& weights, Precision precision,
                             const kernel::Functions& functions)
    : functions_(&functions),
      feature_mean_(weights.feature_mean),
      feature_inverse_scale_(weights.feature_scale.cwiseInverse()),
      // Features have no bound that 16 bits could be laid over.
      input_(static_cast<int>(weights.features.size()), Precision::kFloat32),
      layers_(),
      dense_weight_(weights.fc_weight.cast<double>(), precision),
      dense_bias_(dense_weight_.paddedRows()),
      dense_(dense_weight_.paddedRows(), precision),
      attention_(weights, precision),
      linear_() {
  layers_.reserve(weights.lstm.size());
  for (const LstmWeights& layer : weights.lstm)
    layers_.emplace_back(layer, layers_.empty() ? Precision::kFloat32 : precision, precision);
  std::copy_n(weights.fc_bias.data(), weights.fc_bias.size(), dense_bias_.data());
  if (!weights.linear_lags.empty())
    linear_.emplace(weights);
}

void AttentionLstm::reset() noexcept {
  for (LstmLayer& layer : layers_)
    layer.reset();
  attention_.reset();
  if (linear_)
    linear_->reset();
  prepared_ = false;
}

void AttentionLstm::prepare() noexcept PATELLA_NONBLOCKING {
  if (prepared_)
    return;
  for (LstmLayer& layer : layers_)
    layer.prepare(*functions_);
  if (linear_)
    linear_->prepare();
  prepared_ = true;
}

JointVector AttentionLstm::step(std::span<const double> features) noexcept PATELLA_NONBLOCKING {
  JointVector output(outputs());
  if (!normalise(features)) {
    output.setConstant(std::numeric_limits<double>::quiet_NaN());
    return output;
  }
  const Signal* signal = &input_;
  float poison = 0.0F;
  for (LstmLayer& layer : layers_) {
    layer.step(*functions_, *signal, prepared_);
    signal = &layer.hidden();
    poison += signal->poison();
  }
  dense_weight_.productTanh(*functions_, *signal, dense_bias_.data(), dense_.data());
  dense_.round(*functions_);
  attention_.step(*functions_, dense_, output.data());
  if (linear_) {
    if (!prepared_)
      linear_->prepare();
    linear_->step(*functions_, input_, output.data());
  }
  output.array() += static_cast<double>(poison + dense_.poison());
  prepared_ = false;
  return output;
}

bool AttentionLstm::normalise(std::span<const double> features) noexcept {
  if (features.size() != static_cast<std::size_t>(feature_mean_.size()))
    return false;
  bool finite = true;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double value = (features[i] - feature_mean_[index]) * feature_inverse_scale_[index];
    const bool fits = std::abs(value) <= std::numeric_limits<float>::max();
    input_.data()[i] = fits ? static_cast<float>(value) : 0.0F;
    finite = finite && fits;
  }
  return finite;
}

}  // namespace patella::network
