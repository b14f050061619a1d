// The state of a training, to the bit, as a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/train/torch_adam.hpp"
#include "tools/train/trainer.hpp"

namespace patella::train {

struct TrainingState {
  NamedTensors parameters;
  NamedTensors kept;  ///< of the epoch that is kept so far
  Adam adam;
  std::vector<Epoch> curve;
};

/// `identity` names options and data. Appears whole or not at all. Throws app::FileError.
void saveCheckpoint(const std::filesystem::path& path, const std::string& identity,
                    const TrainingState& state);

/// Into a state whose tensors have the right shapes. Throws app::FileError naming the file when it is damaged
/// or of another identity.
void loadCheckpoint(const std::filesystem::path& path, const std::string& identity, TrainingState& state);

/// A few words that differ when options, data or one of the libraries' versions differ.
std::string identityOf(std::span<const Sequence> sequences, const network::NetworkWeights& frame,
                       const TrainingOptions& options);

}  // namespace patella::train
