#include "core/network/lstm_layer.hpp"

#include <algorithm>

#include "core/network/kernel.hpp"

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
          unit / kernel::kUnits * kPanel + gate * kernel::kUnits + unit % kernel::kUnits;
      packed.row(target) = rows.row(gate * units + unit) * (gate == kCandidate ? 1.0 : 0.5);
    }
  return packed;
}

}  // namespace

LstmLayer::LstmLayer(const LstmWeights& weights)
    : units_(paddedUnits(weights)),
      input_weight_(interleaveGates(weights.weight_ih.cast<double>(), units_)),
      hidden_weight_(interleaveGates(weights.weight_hh.cast<double>(), units_)),
      bias_(4 * units_),
      gates_(4 * units_),
      cell_(units_),
      hidden_(units_) {
  const Eigen::VectorXd bias = weights.bias_ih.cast<double>() + weights.bias_hh.cast<double>();
  const Eigen::MatrixXd packed = interleaveGates(bias, units_);
  std::transform(packed.data(), packed.data() + packed.size(), bias_.data(),
                 [](double value) { return static_cast<float>(value); });
}

void LstmLayer::reset() noexcept {
  cell_.setZero();
  hidden_.setZero();
}

void LstmLayer::prepare() noexcept {
  std::copy_n(bias_.data(), bias_.size(), gates_.data());
  kernel::addProduct(hidden_weight_, hidden_.data(), gates_.data());
}

void LstmLayer::step(const float* input) noexcept {
  kernel::addProduct(input_weight_, input, gates_.data());
  kernel::lstmCell(gates_.data(), units_, cell_.data(), hidden_.data());
}

}  // namespace patella::network
