// Where a network comes from, as it stands in its weights file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/train/preparation.hpp"
#include "tools/train/score.hpp"
#include "tools/train/split.hpp"
#include "tools/train/trainer.hpp"

namespace patella::train {

/// A recording that was used, and for what.
struct UsedRecording {
  std::string name;
  std::string sha256;
  std::string use;  ///< "training" where any of its steps were trained on, or "validation" or "test"
};

std::vector<UsedRecording> usesOf(std::span<const Sequence> sequences);

struct ModelCard {
  std::vector<UsedRecording> data;
  std::string config_sha256;
  std::string model_sha256;
  std::string split;  ///< in words, with its seed
  Target target = Target::kSmoothed;
  double horizon_s = 0.0;
  TrainingOptions options;
  std::vector<Epoch> curve;
  int kept_epoch = 0;
  std::string stopped_by;
  std::optional<Score> test;  ///< empty: nothing was held out
};

/// As metadata of the weights file: keys that loading ignores, values as text, tables as JSON.
std::map<std::string, std::string> metadataOf(const ModelCard& card);

/// The recordings that a weights file says it has seen. Throws app::FileError when it does not tell, or not
/// so that it can be read.
std::vector<UsedRecording> dataOf(const std::filesystem::path& weights,
                                  const std::map<std::string, std::string>& metadata);

/// Throws std::invalid_argument naming the first recording that training has seen, under whatever name.
void refuseTrained(std::span<const UsedRecording> known, const std::string& name, const std::string& sha256);

}  // namespace patella::train
