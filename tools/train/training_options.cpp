#include <stdexcept>

#include "firmware_app/files/wording.hpp"
#include "tools/train/trainer.hpp"

namespace patella::train {
namespace {

constexpr int kMostThreads = 256;

void require(bool good, const char* option, double value, const std::string& expected) {
  if (!good) {
    throw std::invalid_argument(std::string(option) + ": value " + app::formatNumber(value) + ", expected " +
                                expected);
  }
}

}  // namespace

const std::vector<std::string>& stoppingNames() {
  static const std::vector<std::string> names = {"none", "paper", "validation"};
  return names;
}

const std::vector<std::string>& initialisationNames() {
  static const std::vector<std::string> names = {"pytorch", "spread"};
  return names;
}

const TrainingOptions& checked(const TrainingOptions& o) {
  const auto width = [](Eigen::Index value) { return value >= 1 && value <= network::kMaxWidth; };
  require(o.layers == 1 || o.layers == 2, "layers", static_cast<double>(o.layers), "1 or 2");
  require(width(o.hidden), "hidden", static_cast<double>(o.hidden), "1 to 4096");
  require(width(o.channels), "channels", static_cast<double>(o.channels), "1 to 4096");
  require(o.heads >= 1 && o.channels % o.heads == 0, "heads", o.heads,
          "a divisor of the " + std::to_string(o.channels) + " channels");
  require(o.window >= 1 && o.window <= network::kMaxWindow, "window", o.window, "1 to 4096");
  require(o.patience >= 1, "patience", o.patience, "at least 1");
  require(o.epochs >= 1, "epochs", o.epochs, "at least 1");
  require(o.batch >= 1, "batch", o.batch, "at least 1");
  require(o.burn_in >= 0, "burn_in", o.burn_in, "0 or more");
  network::checkLinearLags(o.linear_lags);
  require(o.sequence_steps > o.burn_in, "sequence_steps", o.sequence_steps, "more than those of the burn-in");
  require(o.learning_rate > 0.0 && o.learning_rate < 1.0, "learning_rate", o.learning_rate,
          "above 0 and below 1");
  require(o.weight_decay >= 0.0 && o.weight_decay < 1.0, "weight_decay", o.weight_decay,
          "0 or more and below 1");
  require(o.turn_s > 0.0, "turn_s", o.turn_s, "above 0");
  require(o.threads >= 1 && o.threads <= kMostThreads, "threads", o.threads,
          "1 to " + std::to_string(kMostThreads));
  return o;
}

}  // namespace patella::train
