// Sequences with something to be learned, and a training that takes a second.
#pragma once

#include <vector>

#include "tools/train/trainer.hpp"

namespace patella::train {

/// Two features; the reference is a mean over their last steps, bent, and the observer sees part of it.
std::vector<Sequence> madeUpSequences(int count, Eigen::Index steps);
network::NetworkWeights madeUpFrame(const std::vector<Sequence>& sequences,
                                    network::OutputKind output = network::OutputKind::kTorque);
TrainingOptions smallTraining();

}  // namespace patella::train
