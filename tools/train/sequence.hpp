// Training sequences: the features of a recording as the loop would have them, and beside them what
// the network is to say.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/network/network_weights.hpp"
#include "core/types.hpp"

namespace patella::train {

/// steps x features or joints.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The role of a step.
enum class Role : std::uint8_t {
  kIgnored,  ///< seen as past of other steps only
  kTrain,
  kValidation,
  kTest,
};

/// A stretch without a gap at the network's rate. Quantities are accelerations or torques, as the network's
/// output is; `reference` and `observer` are whole ones where the output is a correction.
struct Sequence {
  std::string name;    ///< of the recording
  std::string sha256;  ///< likewise
  double rate_Hz = 0.0;
  Rows features;           ///< physical units
  Rows reference;          ///< what is to be estimated, of the instant that the forecast is of
  Rows observer;           ///< the observer's filtered estimate, now
  std::vector<Role> role;  ///< one a step

  Eigen::Index steps() const noexcept { return features.rows(); }
};

/// True where the network's output is added to the observer's estimate.
bool isCorrection(network::OutputKind output) noexcept;
/// True where it is a torque.
bool isTorque(network::OutputKind output) noexcept;

/// The network's target: the reference, less the observer where it corrects.
Rows targetOf(const Sequence& sequence, network::OutputKind output);

/// (row − mean) / scale of every row.
Rows scaled(const Rows& rows, const Eigen::VectorXd& mean, const Eigen::VectorXd& scale);

/// Features, their order, the output's meaning and its rate, with means and scales over the steps that are
/// trained on. No tensors yet. A feature that never changes has scale 1. Throws std::invalid_argument where
/// there is no such step.
network::NetworkWeights frameOf(std::span<const Sequence> sequences, const std::vector<std::string>& features,
                                network::OutputKind output);

}  // namespace patella::train
