// The paper's own setting, and the same network where neighbours in time are not trained on.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/observers/condition.hpp"
#include "tools/train/split.hpp"
#include "tools/train/trainer.hpp"

namespace patella::bench {

struct PaperStudyOptions {
  std::vector<Experiment> experiments{Experiment::kFirst, Experiment::kSecond};
  std::vector<train::SplitKind> splits{train::SplitKind::kRandom, train::SplitKind::kBlocked,
                                       train::SplitKind::kChronological};
  int seeds = 3;
  double seconds = 50.0;
  double rate_Hz = 100.0;
  train::TrainingOptions training;
};

/// Mean |f_u − estimate|, rad/s², against the truth.
struct PaperResult {
  Experiment experiment = Experiment::kFirst;
  std::string tested_on;
  std::uint64_t seed = 0;
  std::array<double, 2> network{};
  std::array<double, 2> smoother{};  ///< the target that was trained on
  std::array<double, 2> zero{};      ///< saying nothing
};

/// Preset paper, Gaussian 0.01 rad/s on velocity; features φ, φ̇, t; target the offline smoother in torque
/// space, tuned by the rule of patella-bench-observers on a seed of its own. Beside the tests of the splits,
/// the network of the random split goes over an experiment with other torques, the same h(t): "unseen
/// trajectory".
std::vector<PaperResult> paperStudy(const PaperStudyOptions& options,
                                    const std::function<void(const PaperResult&)>& done = {});

}  // namespace patella::bench
