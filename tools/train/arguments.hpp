// Arguments of patella-train.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/recordings/recording_file.hpp"
#include "tools/train/preparation.hpp"
#include "tools/train/split.hpp"
#include "tools/train/trainer.hpp"

namespace patella::train {

struct Arguments {
  std::filesystem::path config;
  std::vector<std::filesystem::path> data;
  std::vector<std::filesystem::path> validation_data;
  std::vector<std::filesystem::path> test_data;
  std::filesystem::path weights;  ///< made by fit, read by score
  std::filesystem::path curves;   ///< empty: beside the weights
  diagnose::RecordingOptions recording;
  std::string torque_timing;
  std::vector<std::string> features{"deployable"};  ///< a set, or names
  std::string output;                               ///< empty: as the set of features suggests
  std::string target = "smoothed";
  double horizon_ms = 0.0;
  double rate_Hz = 100.0;
  double smoothing_Hz = 0.0;
  std::string split_name = "blocked";
  SplitOptions split;
  std::string attention_scale = "inv_sqrt";
  std::vector<std::string> linear_lags;  ///< numbers, or a word; empty: as the features suggest
  std::string linear_loss = "squared";
  std::string initialisation = "pytorch";
  std::string loss = "squared";
  std::string stopping = "validation";
  TrainingOptions training;
};

void declareFit(CLI::App& app, Arguments& arguments);
void declareScore(CLI::App& app, Arguments& arguments);

/// Puts what was given as words into split, training and recording. Throws std::invalid_argument.
void understand(Arguments& arguments);

network::OutputKind outputOf(const Arguments& arguments);

}  // namespace patella::train
