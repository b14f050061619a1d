#include "core/network/lstm_layer.hpp"

#include <algorithm>

namespace patella::network {

namespace {

int paddedUnits(const LstmWeights& weights) {
  return roundUpToPanel(4 * static_cast<int>(weights.weight_hh.cols())) / 4;
}

/// PyTorch's order of rows (all i, all f, all g, all o) into the kernel's: panels of kUnits i, f, g, o, the
/// sigmoid gates halved, which loses nothing in binary.
Eigen::MatrixXd interleaveGates(const Eigen::MatrixXd& rows, Eigen::Index padded_units) {
  constexpr Eigen::Index kCandidate = 2;
  const Eigen::Index units = rows.rows() / 4;
  Eigen::MatrixXd packed = Eigen::MatrixXd::Zero(4 * padded_units, rows.cols());
  for (Eigen::Index gate = 0; gate < 4; ++gate)
    for (Eigen::Index unit = 0; unit < units; ++unit) {
      const Eigen::Index target =
          unit / kernel::kUnits * kernel::kPanel + gate * kernel::kUnits + unit % kernel::kUnits;
      packed.row(target) = rows.row(gate * units + unit) * (gate == kCandidate ? 1.0 : 0.5);
    }
  return packed;
}

}  // namespace

LstmLayer::LstmLayer(const LstmWeights& weights, Precision input_precision, Precision precision)
    : units_(paddedUnits(weights)),
      input_weight_(interleaveGates(weights.weight_ih.cast<double>(), units_), input_precision),
      hidden_weight_(interleaveGates(weights.weight_hh.cast<double>(), units_), precision),
      bias_(4 * units_),
      gates_(4 * units_),
      cell_(roundUpToPanel(units_)),
      hidden_(units_, precision) {
  const Eigen::VectorXd bias = weights.bias_ih.cast<double>() + weights.bias_hh.cast<double>();
  const Eigen::MatrixXd packed = interleaveGates(bias, units_);
  std::transform(packed.data(), packed.data() + packed.size(), bias_.data(),
                 [](double value) { return static_cast<float>(value); });
}

void LstmLayer::reset() noexcept {
  cell_.setZero();
  hidden_.setZero();
}

void LstmLayer::prepare(const kernel::Functions& functions) noexcept {
  hidden_weight_.product(functions, hidden_, bias_.data(), gates_.data());
}

void LstmLayer::step(const kernel::Functions& functions, const Signal& input, bool prepared) noexcept {
  if (prepared)
    input_weight_.productTanh(functions, input, gates_.data(), gates_.data());
  else
    hidden_weight_.productTanh(functions, hidden_, input_weight_, input, bias_.data(), gates_.data());
  functions.lstm_cell(gates_.data(), units_, cell_.data(), hidden_.data());
  hidden_.round(functions);
}

}  // namespace patella::network
