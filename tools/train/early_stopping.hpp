// When enough has been learned.
#pragma once

#include <span>

#include "tools/train/trainer.hpp"

namespace patella::train {

/// Index of the epoch whose weights are to be kept: the lowest validation loss, the first of equals; without
/// validation the last.
std::size_t keptEpoch(std::span<const Epoch> curve, Stopping stopping);

/// True when the rule of `options` says that the training ends with the last epoch of the curve.
bool isEnough(std::span<const Epoch> curve, const TrainingOptions& options);

}  // namespace patella::train
