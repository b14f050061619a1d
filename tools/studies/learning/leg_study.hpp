// A network on the best observer against that observer alone, on legs, motions and pushes that neither has
// seen.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/studies/learning/leg_runs.hpp"
#include "tools/train/trainer.hpp"

namespace patella::study {

struct LegStudyOptions {
  std::vector<ModelError> errors;
  std::vector<double> horizons_s{0.0};
  bool ablations = false;  ///< besides: without linear path, attention, rises, what the observer says at all
  bool shank_share = false;  ///< besides: networks that see what ShankShare explains
  bool passive = false;      ///< trained on runs in which the patient does not push, tested where he does
  bool adapt = false;   ///< besides: filters that adapt the model's parameters, from nominal and as trained
  bool network = true;  ///< false: without it and its training, observers and filters alone
  int first_seed = 1;
  int seeds = 3;
  int training_runs = 30;
  int validation_runs = 6;
  int test_runs = 10;
  int tuning_runs = 3;  ///< of the training runs
  double seconds = 12.0;
  double rate_Hz = 100.0;
  train::TrainingOptions training;
};

/// Result of one estimator in one condition and one seed.
struct LegResult {
  std::string condition;
  std::string estimator;
  std::uint64_t seed = 0;
  double horizon_s = 0.0;
  std::array<double, 2> error_Nm{};  ///< mean absolute, at every encoder sample of the test
  std::array<double, 2> delay_s{};
};

/// "shank 5 % wrong", …
std::string nameOf(const ModelError& error);

/// Each result goes to `done` as it comes.
std::vector<LegResult> legStudy(const LegStudyOptions& options,
                                const std::function<void(const LegResult&)>& done = {});

}  // namespace patella::study
