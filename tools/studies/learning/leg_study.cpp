#include "tools/studies/learning/leg_study.hpp"

#include <limits>
#include <optional>

#include <fmt/format.h>

#include "tools/studies/learning/adaptation.hpp"
#include "tools/studies/learning/forecast.hpp"
#include "tools/train/linear_path.hpp"
#include "tools/train/preparation.hpp"

namespace patella::study {
namespace {

using train::Role;
using train::Sequence;

constexpr std::uint64_t kSeedSpan = 10000;
constexpr std::uint64_t kValidationFrom = 3000;
constexpr std::uint64_t kTestFrom = 6000;

/// The contenders of one condition, tuned.
struct Contenders {
  Tuned observer;  ///< of all causal ones
  Tuned filter;    ///< of the Kalman filters of constant rate; forecasts
  std::vector<std::pair<AdaptedBody, std::vector<double>>> adaptive{};  ///< with their numbers
};

/// Those with the smallest mean error, summed over joints and runs, each tuned on these runs.
Contenders bestOf(const std::vector<Recording>& runs) {
  Contenders best;
  double lowest = std::numeric_limits<double>::infinity();
  double lowest_filter = lowest;
  for (const Method& method : methods()) {
    if (method.kind != Method::Kind::kCausal || !method.takes_encoder_only) {
      continue;
    }
    const Tuned tuned{&method, tune(method, runs)};
    double sum = 0.0;
    for (const Recording& run : runs) {
      const auto error = meanError(follow(method, tuned.values, run));
      sum += error[0] + error[1];
    }
    if (sum < lowest) {
      lowest = sum;
      best.observer = tuned;
    }
    if (sum < lowest_filter && knowsRate(tuned, runs.front().condition)) {
      lowest_filter = sum;
      best.filter = tuned;
    }
  }
  return best;
}

std::vector<ObservedRun> observeAll(const std::vector<Recording>& recordings, const Tuned& observer) {
  std::vector<ObservedRun> runs;
  for (const Recording& recording : recordings) {
    runs.push_back(observeRun(recording, observer));
  }
  return runs;
}

Contenders contendersOf(const std::vector<Recording>& runs, bool adapt) {
  Contenders contenders = bestOf(runs);
  if (adapt) {
    for (const AdaptedBody body : {AdaptedBody::kShank, AdaptedBody::kWhole}) {
      contenders.adaptive.emplace_back(body, tune(adaptiveMethod(body), runs));
    }
  }
  return contenders;
}

/// One condition and seed.
class Trial {
 public:
  Trial(const LegStudyOptions& options, const ModelError& error, std::uint64_t seed,
        const Contenders& contenders, std::vector<LegResult>& results,
        const std::function<void(const LegResult&)>& done)
      : options_(options),
        error_(error),
        seed_(seed),
        contenders_(contenders),
        observer_(contenders.observer),
        results_(results),
        done_(done) {
    LegRunOptions run{.seconds = options.seconds, .error = error, .passive = options.passive};
    const std::uint64_t first = kSeedSpan * seed;
    training_recordings_ = recordLegs(run, first, options.training_runs);
    training_ = observeAll(training_recordings_, observer_);
    validation_ = observeAll(recordLegs(run, first + kValidationFrom, options.validation_runs), observer_);
    run.passive = false;
    test_recordings_ = recordLegs(run, first + kTestFrom, options.test_runs);
    test_ = observeAll(test_recordings_, observer_);
  }

  void run(double horizon_s) {
    report(observer_.method->name, horizon_s,
           [&](std::size_t i) { return deliverObserver(test_[i], horizon_s); });
    if (horizon_s > 0.0) {
      report("constant rate", horizon_s, [&](std::size_t i) {
        return predictConstantRate(test_recordings_[i], test_[i], contenders_.filter, horizon_s);
      });
    }
    for (const auto& [body, values] : contenders_.adaptive) {
      reportAdaptive(body, values, horizon_s);
    }
    if (!options_.network) {
      return;
    }
    const Inputs inputs{.preparation = {.features = train::deployableFeatures(2, false),
                                        .output = network::OutputKind::kTorqueCorrection,
                                        .rate_Hz = options_.rate_Hz,
                                        .horizon_s = horizon_s}};
    reportNetwork("network", inputs, options_.training);
    reportLinear("linear path alone", inputs);
    if (options_.shank_share) {
      Inputs more = inputs;
      more.shank_share = true;
      reportNetwork("network with the shank's share", more, options_.training);
      reportLinear("linear path alone with the shank's share", more);
    }
    if (options_.ablations) {
      runAblations(inputs);
    }
  }

 private:
  void runAblations(Inputs inputs) {
    train::TrainingOptions training = options_.training;
    training.linear_lags.clear();
    reportNetwork("without the linear path", inputs, training);
    training = options_.training;
    training.window = 1;
    reportNetwork("without attention", inputs, training);
    Inputs now = inputs;
    std::erase_if(now.preparation.features,
                  [](const std::string& name) { return name.starts_with("d_rise"); });
    reportNetwork("without rises", now, options_.training);
    inputs.preparation.features = {"q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s", "tau1_Nm", "tau2_Nm"};
    inputs.preparation.output = network::OutputKind::kTorque;
    reportNetwork("without the observer", inputs, options_.training);
  }

  std::vector<Sequence> sequences(const Inputs& inputs) const {
    std::vector<Sequence> all;
    for (const ObservedRun& run : training_) {
      all.push_back(sequenceOf(run, inputs, Role::kTrain, fmt::format("training {}", all.size())));
    }
    for (const ObservedRun& run : validation_) {
      all.push_back(sequenceOf(run, inputs, Role::kValidation, fmt::format("validation {}", all.size())));
    }
    return all;
  }

  /// Each test run from the nominal model; then from what the training runs, which need no truth for that,
  /// have taught of the rig.
  void reportAdaptive(AdaptedBody body, std::span<const double> values, double horizon_s) {
    const std::string name = adaptiveMethod(body).name;
    AdaptiveFilter filter = makeAdaptiveFilter(body, values);
    report(name, horizon_s, [&](std::size_t i) {
      return deliverAdaptive(filter, test_recordings_[i], test_[i], false, horizon_s);
    });
    for (std::size_t i = 0; i < training_.size(); ++i) {
      deliverAdaptive(filter, training_recordings_[i], training_[i], i > 0, horizon_s);
    }
    const AdaptiveFilter trained = filter;
    report(name + ", after the training runs", horizon_s, [&](std::size_t i) {
      AdaptiveFilter copy = trained;
      return deliverAdaptive(copy, test_recordings_[i], test_[i], true, horizon_s);
    });
  }

  void reportNetwork(const std::string& name, const Inputs& inputs, train::TrainingOptions training) {
    training.seed = seed_;
    const std::vector<Sequence> all = sequences(inputs);
    const train::Trained trained =
        trainNetwork(all, frameOf(all, namesOf(inputs), inputs.preparation.output), training);
    reportWeights(name, inputs, trained.weights);
  }

  void reportLinear(const std::string& name, const Inputs& inputs) {
    const std::vector<Sequence> all = sequences(inputs);
    reportWeights(name, inputs, linearNetwork(all, frameOf(all, namesOf(inputs), inputs.preparation.output)));
  }

  void reportWeights(const std::string& name, const Inputs& inputs, const network::NetworkWeights& weights) {
    report(name, inputs.preparation.horizon_s,
           [&](std::size_t i) { return deliverNetwork(test_[i], inputs, weights); });
  }

  template <typename Deliver>
  void report(const std::string& estimator, double horizon_s, Deliver deliver) {
    Delivered all;
    for (std::size_t i = 0; i < test_.size(); ++i) {
      append(all, deliver(i));
    }
    LegResult result{.condition = nameOf(error_),
                     .estimator = estimator,
                     .seed = seed_,
                     .horizon_s = horizon_s,
                     .error_Nm = meanError(all),
                     .delay_s = delay_s(all)};
    results_.push_back(result);
    if (done_) {
      done_(result);
    }
  }

  const LegStudyOptions& options_;
  ModelError error_;
  std::uint64_t seed_;
  const Contenders& contenders_;
  const Tuned& observer_;
  std::vector<LegResult>& results_;
  const std::function<void(const LegResult&)>& done_;
  std::vector<Recording> training_recordings_;
  std::vector<ObservedRun> training_;
  std::vector<ObservedRun> validation_;
  std::vector<Recording> test_recordings_;
  std::vector<ObservedRun> test_;
};

}  // namespace

std::string nameOf(const ModelError& error) {
  std::string name = error.shank == 0.0 ? std::string("right model")
                                        : fmt::format("shank {:g} % wrong", 100.0 * error.shank);
  if (error.individual) {
    name = fmt::format("shank up to ±{:g} % wrong, each patient his own", 100.0 * error.shank);
  }
  return error.friction ? (error.shank == 0.0 ? "undeclared friction" : name + ", undeclared friction")
                        : name;
}

std::vector<LegResult> legStudy(const LegStudyOptions& options,
                                const std::function<void(const LegResult&)>& done) {
  std::vector<LegResult> results;
  const auto first = static_cast<std::uint64_t>(options.first_seed);
  for (const ModelError& error : options.errors) {
    const LegRunOptions run{.seconds = options.seconds, .error = error};
    const Contenders contenders =
        contendersOf(recordLegs(run, kSeedSpan * first, options.tuning_runs), options.adapt);
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(options.seeds); ++seed) {
      Trial trial(options, error, seed, contenders, results, done);
      for (const double horizon_s : options.horizons_s) {
        trial.run(horizon_s);
      }
    }
  }
  return results;
}

}  // namespace patella::study
