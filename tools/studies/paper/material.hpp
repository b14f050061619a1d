// Training data of the paper's network in one experiment, with the truth beside them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/studies/observers/evaluation.hpp"
#include "tools/train/sequence.hpp"
#include "tools/train/split.hpp"

namespace patella::study {

struct Material {
  train::Sequence sequence;  ///< features φ, φ̇, t; `reference` is the smoothed target
  train::Rows truth;         ///< steps x joints, in the unit of the condition
};

/// The method of patella-study-observers that makes the target: the offline smoother in torque space.
const Method& targetSmoother();

/// `values`: numbers of the smoother. `rate_Hz`, of the network, is a whole part of the recording's.
Material materialOf(const Recording& recording, std::span<const double> values, double rate_Hz);

/// Means and scales of the trained steps; one scale for both outputs, as the errors of both count alike.
network::NetworkWeights paperFrame(const Material& material, const Condition& condition);

/// Mean |difference| over the steps that are tested on, joint by joint.
std::array<double, 2> meanOverTest(const train::Rows& difference, const std::vector<train::Role>& role);

}  // namespace patella::study
