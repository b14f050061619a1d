// The network written out as sums over indices, in double, straight from the equations.
#pragma once

#include "core/network/network_weights.hpp"

namespace patella::network {

/// `features` is steps x inputs, the result steps x outputs, both in physical units.
Eigen::MatrixXd loopReference(const NetworkWeights& weights, const Eigen::MatrixXd& features);

}  // namespace patella::network
