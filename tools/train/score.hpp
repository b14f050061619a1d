// How well a network does on what it was not trained on.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/network/network_weights.hpp"
#include "tools/train/sequence.hpp"

namespace patella::train {

/// Errors against the reference, joint by joint, in the unit of the network's output.
struct Errors {
  PerJoint mean_absolute{};
  PerJoint rms{};
};

struct Score {
  std::size_t steps = 0;
  std::size_t joints = 0;
  Errors network;   ///< what the loop would deliver, by the loop's own kernel
  Errors observer;  ///< the observer's filtered estimate alone; of a forecast, held
  Errors zero;      ///< saying nothing
};

/// Streams every sequence through the loop's kernel and counts the steps of a role. Throws
/// std::invalid_argument when asked for what was trained on: no score is given on that.
Score scoreOf(const network::NetworkWeights& weights, std::span<const Sequence> sequences, Role role);

/// steps x joints: what the loop would deliver, the observer's part included.
Rows deliveredOf(const network::NetworkWeights& weights, const Sequence& sequence);

/// "rad/s²" or "N·m".
std::string unitOf(network::OutputKind output);
/// The errors, a line for each joint.
std::string scoreText(const Score& score, network::OutputKind output);

}  // namespace patella::train
