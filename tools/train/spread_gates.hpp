// Where the gates of a fresh network turn.
#pragma once

#include <cstdint>
#include <span>

#include "tools/train/sequence.hpp"

namespace patella::train {

/// Draws the input weights of the first layer anew, so that every input gate, output gate and candidate turns
/// (what it adds up is zero) at a trained step drawn by lot and, where time_s is among the features, within
/// about `turn_s` of it. As PyTorch initialises them, all turn near the features' mean and take the whole
/// recording for it, and what changes within seconds is learned slowly. Weights are uniform within
/// ±1/√inputs, those of time within ± its scale / turn_s. Forget gates begin at one half whatever the
/// features say: what a network remembers is learned.
///
/// `weights` as of initialise(). Deterministic in the seed. Throws std::invalid_argument where no step is
/// trained on.
void spreadGates(network::NetworkWeights& weights, std::span<const Sequence> sequences, double turn_s,
                 std::uint64_t seed);

}  // namespace patella::train
