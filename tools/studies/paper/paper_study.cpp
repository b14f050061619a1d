#include "tools/studies/paper/paper_study.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/studies/paper/network_case.hpp"
#include "tools/studies/paper/observer_case.hpp"
#include "tools/studies/paper/pace.hpp"

namespace patella::study {
namespace {

using Tell = std::function<void(const std::string&)>;

constexpr double kBetweenLines_s = 10.0;

std::string titleOf(const Condition& condition) {
  return fmt::format("experiment {}, {}", numberOf(condition.experiment), formName(condition));
}

class Study {
 public:
  Study(const PaperOptions& options, Tell tell)
      : options_(options), tell_(std::move(tell)), kept_(options.folder) {
    for (const Condition& condition : options.conditions) {
      for (std::size_t i = 0; options.observers && i < methods().size(); ++i) {
        expect(Pace::kObserver, findObserver(kept_, options, condition, methods()[i]).has_value());
      }
      for (const train::SplitKind split : options.splits) {
        for (int seed = 1; seed <= options.seeds; ++seed) {
          expect(Pace::kNetwork,
                 findCase(kept_, options, condition, split, static_cast<std::uint64_t>(seed)).has_value());
        }
      }
    }
  }

  PaperResults run() {
    PaperResults results{.observer_seeds = options_.seeds, .observers = {}, .networks = {}};
    for (const Condition& condition : options_.conditions) {
      if (options_.observers) {
        observe(condition, results.observers);
      }
    }
    // Seed by seed, so that a run that is cut short has something of everything.
    for (int seed = 1; seed <= options_.seeds; ++seed) {
      for (const Condition& condition : options_.conditions) {
        for (const train::SplitKind split : options_.splits) {
          const auto number = static_cast<std::uint64_t>(seed);
          if (auto found = findCase(kept_, options_, condition, split, number)) {
            results.networks.push_back(std::move(*found));
          } else if (!options_.kept_only) {
            results.networks.push_back(train(condition, split, number));
          }
        }
      }
    }
    return results;
  }

 private:
  void expect(Pace::Kind kind, bool is_kept) {
    if (!is_kept) {
      pace_.expect(kind);
    }
  }

  void say(const std::string& text) const {
    if (tell_) {
      tell_(text);
    }
  }

  void observe(const Condition& condition, std::vector<Result>& results) {
    std::optional<ObserverMaterial> material;
    for (const Method& method : methods()) {
      if (const auto found = findObserver(kept_, options_, condition, method)) {
        results.push_back(*found);
        continue;
      }
      if (options_.kept_only) {
        continue;
      }
      if (!material) {
        material = observerMaterial(options_, condition);
      }
      pace_.begin();
      results.push_back(measureObserver(kept_, options_, *material, method));
      pace_.end(Pace::kObserver);
      const Result& result = results.back();
      say(fmt::format("{}: {}: {:.4f} / {:.4f}; {}\n", titleOf(condition), method.name, result.error[0].mean,
                      result.error[1].mean, pace_.left()));
    }
  }

  NetworkCase train(const Condition& condition, train::SplitKind split, std::uint64_t seed) {
    const std::string title = fmt::format("{}, {}, seed {}", titleOf(condition),
                                          train::splitNames()[static_cast<std::size_t>(split)], seed);
    pace_.begin();
    auto told = std::chrono::steady_clock::now();
    const auto progress = [&](const train::Progress& p) {
      const auto now = std::chrono::steady_clock::now();
      if (std::chrono::duration<double>(now - told).count() >= kBetweenLines_s) {
        told = now;
        say(fmt::format("{}: epoch {} of {}, loss {:.3g}, {:.1f} epochs/s; {}\n", title, p.epoch, p.epochs,
                        p.losses.training, p.epochs_per_s, pace_.left(p.left_s, true)));
      }
    };
    NetworkCase one =
        trainCase(kept_, options_, condition, split, seed, targetValues(options_, condition), progress);
    pace_.end(Pace::kNetwork);
    for (const NetworkScore& score : one.scores) {
      say(fmt::format("{}, tested on {}: {:.4f} / {:.4f}; {}\n", title, score.tested_on, score.network[0],
                      score.network[1], pace_.left()));
    }
    return one;
  }

  const PaperOptions& options_;
  Tell tell_;
  KeptResults kept_;
  Pace pace_;
};

}  // namespace

std::string nameOf(Unseen unseen) {
  return unseen == Unseen::kTrajectory ? "unseen trajectory"
                                       : fmt::format("unseen, push {:g} s earlier", kEarlier_s);
}

std::string formName(const Condition& condition) {
  return condition.corrected ? "corrected" : "as printed";
}

int numberOf(sim::PaperExperiment experiment) {
  return experiment == sim::PaperExperiment::kFirst ? 1 : 2;
}

std::vector<double> targetValues(const PaperOptions& options, const Condition& condition) {
  const KeptResults kept(options.folder);
  if (const auto found = findObserver(kept, options, condition, targetSmoother())) {
    return found->values;
  }
  const std::string name = fmt::format("{}_{}_target", condition.corrected ? "corrected" : "as_printed",
                                       numberOf(condition.experiment));
  const std::string settings = fmt::format("{} s, tuned on {} seeds", options.seconds, options.tuning_seeds);
  if (const auto found = kept.find(name, settings)) {
    return found->get<std::vector<double>>();
  }
  const std::vector<double> values =
      tune(targetSmoother(), recordAll(condition, options.seconds, kFirstTuningSeed, options.tuning_seeds));
  kept.keep(name, settings, values);
  return values;
}

train::SplitOptions splitOf(const PaperOptions& options, train::SplitKind split, std::uint64_t seed) {
  return {.kind = split,
          .validation_share = 0.0,
          .test_share = options.test_share,
          .gap_s = options.training.window / options.rate_Hz,
          .seed = seed};
}

PaperResults paperStudy(const PaperOptions& options, const std::function<void(const std::string&)>& tell) {
  return Study(options, tell).run();
}

}  // namespace patella::study
