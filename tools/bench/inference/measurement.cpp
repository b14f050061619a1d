#include "tools/bench/inference/measurement.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>

namespace patella::bench {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kIdle{1};
constexpr int kWarmUp = 8;
constexpr int kColdSteps = 2;  ///< timed in a round after sleep or eviction

double elapsed_ns(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::nano>(to - from).count();
}

double clockCost_ns() {
  std::vector<double> costs;
  for (int i = 0; i < 2000; ++i) {
    const Clock::time_point before = Clock::now();
    costs.push_back(elapsed_ns(before, Clock::now()));
  }
  return quantileOf(std::move(costs), 0.5);
}

/// Signals that go on from call to call.
class Features {
 public:
  std::span<const double> next() {
    ++step_;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = std::sin(0.02 * step_ * (1.0 + 0.3 * static_cast<double>(i)));
    }
    return values_;
  }

 private:
  std::array<double, kInputs> values_{};
  double step_ = 0.0;
};

class Stage {
 public:
  explicit Stage(const MeasurementOptions& options)
      : eviction_(static_cast<std::size_t>(options.eviction_MB) << 20U), clock_cost_ns_(clockCost_ns()) {}

  double timedStep_ns(Contender& contender, Condition condition) {
    const std::span<const double> features = features_.next();
    contender.before();
    if (condition == Condition::kIdle) {
      std::this_thread::sleep_for(kIdle);
    } else if (condition == Condition::kEvicted) {
      evict();
    }
    const Clock::time_point begin = Clock::now();
    seen_ = seen_ + contender.run(features);
    return std::max(elapsed_ns(begin, Clock::now()) - clock_cost_ns_, 0.0);
  }

 private:
  void evict() {
    for (std::size_t i = 0; i < eviction_.size(); i += 64) {
      ++eviction_[i];
    }
  }

  std::vector<char> eviction_;
  double clock_cost_ns_;
  Features features_;
  volatile double seen_ = 0.0;  // an output that nobody sees need not be computed
};

}  // namespace

std::vector<Timing> measure(std::vector<Contender>& contenders, Condition condition,
                            const MeasurementOptions& options) {
  Stage stage(options);
  std::vector<Timing> timings(contenders.size());
  const int steps = condition == Condition::kHot ? options.hot_steps : kColdSteps;
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      for (int step = 0; condition == Condition::kHot && step < kWarmUp; ++step) {
        stage.timedStep_ns(contenders[i], condition);
      }
      std::vector<double> steps_ns;
      for (int step = 0; step < steps; ++step) {
        steps_ns.push_back(stage.timedStep_ns(contenders[i], condition));
      }
      timings[i].steps_ns.insert(timings[i].steps_ns.end(), steps_ns.begin(), steps_ns.end());
      timings[i].rounds_ns.push_back(quantileOf(std::move(steps_ns), 0.5));
    }
  }
  return timings;
}

double quantileOf(std::vector<double> values, double quantile) {
  const auto rank =
      static_cast<std::ptrdiff_t>(std::lround(quantile * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

double ratioOf(const Timing& numerator, const Timing& denominator) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < numerator.rounds_ns.size(); ++i) {
    ratios.push_back(numerator.rounds_ns[i] / denominator.rounds_ns[i]);
  }
  return quantileOf(std::move(ratios), 0.5);
}

}  // namespace patella::bench
