// The linear path of a network, found before the rest of it is trained.
#pragma once

#include <span>
#include <vector>

#include "tools/train/sequence.hpp"
#include "tools/train/trainer.hpp"

namespace patella::train {

/// Steps ago, ten that grow apart: 0.36 s at 100 Hz.
const std::vector<int>& usualLags();

/// Gives linear.weight, for weights.linear_lags as they stand, the ridge regression of the normalised target
/// on the normalised features of those lags over the trained steps, with the ridge that leaves least on
/// validation where there is any, linear.bound a quarter more than the largest that it says over the trained
/// steps, and output.weight and output.bias zeros: what the network says is what is linear, until it has
/// learned more. There is no constant: where the path is not believed, the mean of the target is left. Past
/// steps are those of the sequence, its first standing in for what came before it. `loss` absolute: the sum
/// of absolute errors is least in place of that of squares (iteratively reweighted least squares), both
/// outputs of a step together.
void fitLinearPath(network::NetworkWeights& weights, std::span<const Sequence> sequences,
                   Loss loss = Loss::kSquared);

/// A network that says nothing but what its linear path, of the usual lags, does. `frame` as of frameOf().
network::NetworkWeights linearNetwork(std::span<const Sequence> sequences, network::NetworkWeights frame);

}  // namespace patella::train
