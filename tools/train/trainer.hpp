// Trains a network on sequences. Nothing of libtorch shows here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/train/sequence.hpp"

namespace patella::train {

/// Rule that ends the training before its last epoch.
enum class Stopping : std::uint8_t {
  kNone,
  kPaper,  ///< the training loss changed by less than 0.1 % in five epochs one after the other
  /// The validation loss has had no new minimum for `patience` epochs; the best is kept, or the linear start
  /// where the best is not better by more than one standard error.
  kValidation,
};
/// As written on the command line: none, paper, validation.
const std::vector<std::string>& stoppingNames();

enum class Loss : std::uint8_t {
  kSquared,
  kAbsolute,
};

/// How the weights are drawn.
enum class Initialisation : std::uint8_t {
  kPytorch,  ///< as PyTorch initialises its modules
  kSpread,   ///< likewise, but the first layer's gates turn all over the data: spreadGates()
};
/// As written on the command line: pytorch, spread.
const std::vector<std::string>& initialisationNames();

struct TrainingOptions {
  Eigen::Index layers = 1;  ///< of the LSTM, 1 or 2
  Eigen::Index hidden = 128;
  Eigen::Index channels = 64;  ///< of queries and keys
  int heads = 8;
  int window = 64;
  network::AttentionScale attention_scale = network::AttentionScale::kInvSqrt;
  /// Lags of the linear path beside LSTM and attention, in steps; empty: no such path.
  std::vector<int> linear_lags{};
  Loss linear_loss = Loss::kSquared;  ///< what that path makes least
  Initialisation initialisation = Initialisation::kPytorch;
  double turn_s = 2.0;  ///< of spreadGates()
  Loss loss = Loss::kSquared;
  Stopping stopping = Stopping::kValidation;
  int patience = 20;
  int epochs = 100;
  int batch = 32;
  /// Steps of one truncated back-propagation. Its first `burn_in` steps only fill the memory.
  int sequence_steps = 192;
  int burn_in = 64;
  double learning_rate = 2e-3;  ///< of Adam; falls along half a cosine to a hundredth
  double weight_decay = 0.0;
  std::uint64_t seed = 1;
  int threads = 1;  ///< results are the same for the same number
};

/// Throws std::invalid_argument naming the option, its value and what was expected.
const TrainingOptions& checked(const TrainingOptions& options);

/// Losses of one pass over the data, in units of the outputs' scales; NaN where there is no validation.
struct Epoch {
  double training = 0.0;
  double validation = 0.0;
};

struct Progress {
  int epoch = 0;  ///< done
  int epochs = 0;
  Epoch losses;
  double epochs_per_s = 0.0;
  double left_s = 0.0;  ///< if nothing ends it early
};

struct Trained {
  network::NetworkWeights weights;
  std::vector<Epoch> curve;
  int kept_epoch = 0;      ///< from 1; that of the weights. 0: the linear start, no pass was clearly better
  std::string stopped_by;  ///< for people
};

struct Surroundings {
  /// State after every epoch, from which a killed training goes on; the file is read if it is there, and goes
  /// when the training is done.
  std::optional<std::filesystem::path> checkpoint{};
  std::function<void(const Progress&)> progress{};
};

/// `frame` as of frameOf(). The same numbers for the same arguments, killed and resumed or not. Throws
/// std::invalid_argument, or app::FileError when the checkpoint is of other options or data.
Trained trainNetwork(std::span<const Sequence> sequences, const network::NetworkWeights& frame,
                     const TrainingOptions& options, const Surroundings& surroundings = {});

}  // namespace patella::train
