// Network weights as a safetensors file with PyTorch's names; docs/network.md lists tensors and metadata.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/network/network_weights.hpp"

namespace patella::app {

/// What a file of weights says of where it comes from.
struct WeightsOrigin {
  bool sealed = false;       ///< a digest guards them against flipped bits, see readSafetensors()
  std::string model_sha256;  ///< of the file of the loop's model in training; empty: not told
};

/// Throws FileError naming the file and the tensor or metadata key, what was found and what was
/// expected, when the file is not a sound safetensors file, a tensor is missing, unexpected or of the wrong
/// shape, or a key is missing or does not parse. What it returns passes network::checkWeights.
network::NetworkWeights loadNetworkWeights(const std::filesystem::path& path,
                                           WeightsOrigin* origin = nullptr);

/// Message for a person who loads weights without a seal.
std::string unsealedWarning(const std::filesystem::path& path);

/// Key of WeightsOrigin::model_sha256 among the remarks.
inline constexpr const char* kModelDigest = "card_model_sha256";

/// Throws FileError when the weights do not pass network::checkWeights or cannot be written; a
/// file that was there before is then untouched. `remarks` is metadata beside what loading needs, for people
/// and other programs.
void saveNetworkWeights(const std::filesystem::path& path, const network::NetworkWeights& weights,
                        const std::map<std::string, std::string>& remarks = {});

}  // namespace patella::app
