// The paper's Section 5: observers and the network on the two experiments, as printed and corrected.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/observers/study.hpp"
#include "tools/train/split.hpp"
#include "tools/train/trainer.hpp"

namespace patella::study {

struct PaperOptions {
  std::vector<Condition> conditions;  ///< noise on velocity
  std::vector<train::SplitKind> splits;
  bool observers = true;
  bool kept_only = false;  ///< what is not kept is left out
  int seeds = 10;          ///< measured on 1 … seeds, the observers and the network alike
  int tuning_seeds = 1;    ///< observers and the target's smoother are tuned on 101 …
  double seconds = 50.0;
  double rate_Hz = 100.0;   ///< of the network
  double test_share = 0.5;  ///< in all splits, as in the paper
  train::TrainingOptions training;
  std::filesystem::path folder;  ///< of results that are kept
};

/// Mean |truth − estimate|, joint by joint, in the unit of the condition.
struct NetworkScore {
  std::string tested_on;
  std::array<double, 2> network{};
  std::array<double, 2> target{};  ///< the smoother that was learned from
  std::array<double, 2> nothing{};
};

/// One training.
struct NetworkCase {
  Condition condition;
  train::SplitKind split = train::SplitKind::kRandom;
  std::uint64_t seed = 0;
  std::vector<NetworkScore> scores;  ///< of the split; after random also of what was never seen
  std::vector<train::Epoch> curve;
  double output_scale = 1.0;  ///< by which losses of the curve are divided
  double training_s = 0.0;    ///< wall time, of all sittings but that of what was lost
  network::NetworkWeights weights;
};

struct PaperResults {
  int observer_seeds = 0;         ///< over which their errors are taken
  std::vector<Result> observers;  ///< condition by condition, as methods()
  std::vector<NetworkCase> networks;
};

/// A motion of its own: what the network of the random split is tested on besides.
enum class Unseen : std::uint8_t {
  kTrajectory,  ///< other torques, the same h(t)
  kPush,        ///< other torques, and a push that has begun kEarlier_s before
};
inline constexpr double kEarlier_s = 5.0;
std::string nameOf(Unseen unseen);

/// "as printed" or "corrected".
std::string formName(const Condition& condition);
int numberOf(sim::PaperExperiment experiment);
/// Numbers of the smoother that makes the target, tuned on the tuning seeds or as kept.
std::vector<double> targetValues(const PaperOptions& options, const Condition& condition);
/// The splits' roles for one recording.
train::SplitOptions splitOf(const PaperOptions& options, train::SplitKind split, std::uint64_t seed);

/// `tell` is given lines for who waits.
PaperResults paperStudy(const PaperOptions& options,
                        const std::function<void(const std::string&)>& tell = {});

}  // namespace patella::study
