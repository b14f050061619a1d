#include "tools/studies/observers/study.hpp"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <thread>

namespace patella::study {

std::vector<Recording> recordAll(const Condition& condition, double seconds, std::uint64_t first, int count) {
  std::vector<Recording> recordings;
  for (int i = 0; i < count; ++i) {
    recordings.push_back(record(condition, seconds, first + static_cast<std::uint64_t>(i)));
  }
  return recordings;
}

Spread spreadOf(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  Spread spread;
  for (const double value : values) {
    spread.mean += value / count;
  }
  for (const double value : values) {
    spread.deviation += std::pow(value - spread.mean, 2);
  }
  spread.deviation = values.size() > 1 ? std::sqrt(spread.deviation / (count - 1.0)) : 0.0;
  return spread;
}

Result measure(const Method& method, const std::vector<Recording>& tuning,
               const std::vector<Recording>& recordings) {
  Result result{.condition = tuning.front().condition,
                .method = &method,
                .values = tune(method, tuning),
                .error = {},
                .delay_s = {}};
  std::array<std::vector<double>, 2> error;
  std::array<std::vector<double>, 2> delay;
  for (const Recording& recording : recordings) {
    const Trace trace = follow(method, result.values, recording);
    const auto errors = meanError(trace);
    const auto delays = delay_s(trace);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      error[joint].push_back(errors[joint]);
      delay[joint].push_back(delays[joint]);
    }
  }
  for (std::size_t joint = 0; joint < 2; ++joint) {
    result.error[joint] = spreadOf(error[joint]);
    result.delay_s[joint] = spreadOf(delay[joint]);
  }
  return result;
}

std::vector<Result> study(const StudyOptions& options) {
  const std::vector<Method>& all = methods();
  std::vector<Result> results;
  for (const Condition& condition : options.conditions) {
    std::vector<const Method*> fitting;
    for (const Method& method : all) {
      if (!condition.encoderOnly() || method.takes_encoder_only) {
        fitting.push_back(&method);
      }
    }
    const auto tuning = recordAll(condition, options.seconds, kFirstTuningSeed, options.tuning_seeds);
    const auto recordings = recordAll(condition, options.seconds, 1, options.seeds);
    const std::size_t first = results.size();
    results.resize(first + fitting.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t m = next++; m < fitting.size(); m = next++) {
        results[first + m] = measure(*fitting[m], tuning, recordings);
        std::fprintf(stderr, "experiment %d: %s\n",
                     condition.experiment == sim::PaperExperiment::kFirst ? 1 : 2, fitting[m]->name.c_str());
      }
    };
    std::vector<std::jthread> threads;
    for (int i = 1; i < options.jobs; ++i) {
      threads.emplace_back(work);
    }
    work();
  }
  return results;
}

}  // namespace patella::study
