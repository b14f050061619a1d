#include "tools/train/early_stopping.hpp"

#include <cmath>

namespace patella::train {
namespace {

// The paper: "the normalised loss change below 1e-3 over five consecutive iterations".
constexpr double kPaperChange = 1e-3;
constexpr std::size_t kPaperIterations = 5;

bool stagnates(std::span<const Epoch> curve) {
  if (curve.size() <= kPaperIterations) {
    return false;
  }
  for (std::size_t i = curve.size() - kPaperIterations; i < curve.size(); ++i) {
    const double before = curve[i - 1].training;
    if (!(std::abs(curve[i].training - before) < kPaperChange * std::abs(before))) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::size_t keptEpoch(std::span<const Epoch> curve, Stopping stopping) {
  std::size_t best = curve.size() - 1;
  if (stopping != Stopping::kValidation) {
    return best;
  }
  for (std::size_t i = curve.size() - 1; i-- > 0;) {
    if (curve[i].validation <= curve[best].validation) {
      best = i;
    }
  }
  return best;
}

bool isEnough(std::span<const Epoch> curve, const TrainingOptions& options) {
  switch (options.stopping) {
    case Stopping::kNone:
      return false;
    case Stopping::kPaper:
      return stagnates(curve);
    case Stopping::kValidation:
      break;
  }
  return curve.size() - 1 - keptEpoch(curve, options.stopping) >= static_cast<std::size_t>(options.patience);
}

}  // namespace patella::train
