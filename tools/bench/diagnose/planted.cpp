#include "tools/bench/diagnose/planted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/bench/diagnose/asserted.hpp"
#include "tools/bench/diagnose/in_parallel.hpp"
#include "tools/bench/diagnose/measured_rigs.hpp"
#include "tools/bench/diagnose/planting.hpp"
#include "tools/bench/diagnose/random.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/fit/torque_timing.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/verdict/findings.hpp"

namespace patella::bench {
namespace {

using diagnose::Recording;
using diagnose::Segment;

/// Shortest part of a recording that is diagnosed.
constexpr double kShortest_s = 2.5;

/// Rows `from` … `to` (shares) of the longest stretch.
Recording part(const Recording& whole, double from, double to) {
  const Segment& longest =
      *std::max_element(whole.segments.begin(), whole.segments.end(),
                        [](const Segment& a, const Segment& b) { return a.end - a.first < b.end - b.first; });
  const auto length = static_cast<double>(longest.end - longest.first);
  Recording result = whole;
  result.segments = {{.first = longest.first + static_cast<std::size_t>(from * length),
                      .end = longest.first + static_cast<std::size_t>(to * length)}};
  return result;
}

bool isOf(const diagnose::EffectFinding& finding, const model::EffectDescription& effect) {
  return effect.kind == finding.kind && effect.joint == finding.joint;
}

bool holdsKind(const std::vector<std::string>& kinds, const std::string& kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

struct Half {
  const MeasuredRecording* source = nullptr;
  double from = 0.0, to = 1.0;
  model::ModelDescription model{};  ///< that the other half led to, once it is asked for
  bool other_judges = false;        ///< the other half moved enough to tell, and nobody pushed
};

// Nothing where the recording is refused.
std::optional<diagnose::Diagnosis> decide(const Recording& recording, const model::ModelDescription& model) {
  try {
    diagnose::Diagnosis diagnosis = diagnose::diagnose(std::span(&recording, 1), {}, model, {});
    keepAsserted(diagnosis);
    return diagnosis;
  } catch (const std::invalid_argument& refused) {
    std::fprintf(stderr, "%s\n", refused.what());
    return std::nullopt;
  }
}

/// Diagnoses in a row until nothing more is found; hardly any recording needs as many.
constexpr int kMostRounds = 3;

// The recording with its own best model, to which a diagnosis adds nothing.
std::optional<diagnose::Diagnosis> decideWithBest(const Recording& recording,
                                                  const model::ModelDescription& first) {
  std::optional<diagnose::Diagnosis> best = decide(recording, first);
  const auto added = [](const diagnose::Diagnosis& diagnosis, const model::ModelDescription& given) {
    return diagnosis.extended.effects.size() != given.effects.size();
  };
  model::ModelDescription given = first;
  for (int round = 1; round < kMostRounds && best && added(*best, given); ++round) {
    given = best->extended;
    best = decide(recording, given);
  }
  return best;
}

std::vector<Half> halvesOf(const std::vector<MeasuredRecording>& all) {
  std::vector<Half> halves;
  for (const MeasuredRecording& source : all) {
    const Segment whole = part(source.recording, 0.0, 1.0).segments.front();
    if (static_cast<double>(whole.end - whole.first) < 4.0 * kShortest_s * source.recording.rate_Hz) {
      continue;
    }
    halves.push_back({.source = &source, .from = 0.0, .to = 0.5});
    halves.push_back({.source = &source, .from = 0.5, .to = 1.0});
  }
  return halves;
}

Recording otherHalf(const Half& half) {
  return part(half.source->recording, half.from > 0.0 ? 0.0 : 0.5, half.from > 0.0 ? 0.5 : 1.0);
}

// The model without one of the effects that were found, those in whose place it stands back in it, fitted to
// the same part.
model::ModelDescription refittedWithout(const diagnose::EffectFinding& finding,
                                        const model::ModelDescription& extended, const Half& half,
                                        const diagnose::Dataset& part) {
  model::ModelDescription without = extended;
  std::erase_if(without.effects, [&](const auto& effect) { return isOf(finding, effect); });
  for (const model::EffectDescription& effect : half.model.effects) {
    if (effect.joint == finding.joint &&
        (effect.kind == finding.kind || holdsKind(finding.replaces, effect.kind))) {
      without.effects.push_back(effect);
    }
  }
  diagnose::ModelFitter fitter(part, without, {});
  return fitter.describe(fitter.nominal());
}

// What the other half says of an effect: of two models that were fitted to the diagnosed part, the error
// there of the one with it over that of the one without it, on its joint. Above 1 the effect is false. A
// tremor whose phase wanders is in no model and not judged: 0.
double errorElsewhere(const diagnose::EffectFinding& finding, const model::ModelDescription& extended,
                      const Half& half, const Recording& diagnosed) {
  if (std::none_of(extended.effects.begin(), extended.effects.end(),
                   [&](const auto& effect) { return isOf(finding, effect); })) {
    return 0.0;
  }
  const Recording other = otherHalf(half);
  const diagnose::Dataset data(std::span(&other, 1), {});
  const diagnose::Dataset part(std::span(&diagnosed, 1), {});
  const auto error = [&](const model::ModelDescription& model) {
    return diagnose::jointRms(data, diagnose::residualOf(data, model).residual, finding.joint);
  };
  return error(extended) / error(refittedWithout(finding, extended, half, part));
}

struct Counts {
  std::size_t plain = 0, plain_named = 0, plain_judged = 0, plain_false = 0, plain_refused = 0,
              nothing_shows = 0;
  std::size_t at_smallest = 0, found_at_smallest = 0;
  std::size_t above = 0, right_above = 0;
  std::size_t other = 0, unknown = 0, nothing = 0, poor = 0, refused = 0;  ///< of all planted
  std::size_t sized = 0, interval_holds = 0;
  std::size_t planted() const { return at_smallest + above; }
};

bool names(const diagnose::EffectFinding& finding, const PlantedEffect& plant) {
  return finding.joint == plant.joint &&
         (finding.kind == plant.kind || holdsKind(finding.indistinguishable_from, plant.kind));
}

// The planted number as it was found; nothing where the effect was not found by its own name.
std::optional<diagnose::ParameterEstimate> foundSize(const diagnose::Diagnosis& diagnosis,
                                                     const PlantedEffect& plant) {
  for (const diagnose::EffectFinding& finding : diagnosis.effects) {
    if (finding.joint != plant.joint || finding.kind != plant.kind) {
      continue;
    }
    for (const diagnose::ParameterEstimate& estimate : finding.parameters) {
      if (estimate.name == plant.main) {
        return estimate;
      }
    }
  }
  return std::nullopt;
}

bool holds(const diagnose::ParameterEstimate& estimate, double size) {
  return estimate.ci95[0] <= size && size <= estimate.ci95[1];
}

// `diagnosis`: nothing where the recording was refused.
void mark(const std::optional<diagnose::Diagnosis>& diagnosis, const PlantedEffect& plant, Counts& counts) {
  bool found = false, other = false;
  if (diagnosis) {
    for (const diagnose::EffectFinding& finding : diagnosis->effects) {
      (names(finding, plant) ? found : other) = true;
    }
    if (const auto size = foundSize(*diagnosis, plant)) {
      ++counts.sized;
      counts.interval_holds += holds(*size, plant.size) ? 1 : 0;
    }
    const bool silent = !found && !other;
    counts.unknown += silent && diagnosis->verdict == diagnose::Verdict::kUnknownEffect ? 1 : 0;
    counts.nothing += silent && diagnosis->verdict == diagnose::Verdict::kNothingMissing ? 1 : 0;
    counts.poor += silent && diagnosis->verdict == diagnose::Verdict::kInsufficientExcitation ? 1 : 0;
  }
  counts.refused += diagnosis ? 0 : 1;
  counts.other += other ? 1 : 0;
  if (plant.in_smallest > 1.0) {
    ++counts.above;
    counts.right_above += found && !other ? 1 : 0;
  } else {
    ++counts.at_smallest;
    counts.found_at_smallest += found ? 1 : 0;
  }
}

std::string heading() {
  return fmt::format(
      "  {:<34}{:>7}{:>7}{:>7}{:>7}{:>8}{:>6} |{:>8}{:>7} |{:>7}{:>7} |{:>7}{:>8}{:>8}{:>6}{:>8} "
      "|{:>7}{:>7}\n",
      "", "plain", "named", "judged", "false", "refused", "none", "at size", "found", "above", "right",
      "other", "unknown", "nothing", "poor", "refused", "sized", "holds");
}

std::string line(const std::string& name, const Counts& c) {
  return fmt::format(
      "  {:<34}{:>7}{:>7}{:>7}{:>7}{:>8}{:>6} |{:>8}{:>7} |{:>7}{:>7} |{:>7}{:>8}{:>8}{:>6}{:>8} "
      "|{:>7}{:>7}\n",
      name, c.plain, c.plain_named, c.plain_judged, c.plain_false, c.plain_refused, c.nothing_shows,
      c.at_smallest, c.found_at_smallest, c.above, c.right_above, c.other, c.unknown, c.nothing, c.poor,
      c.refused, c.sized, c.interval_holds);
}

std::string foundText(const std::optional<diagnose::Diagnosis>& diagnosis) {
  if (!diagnosis) {
    return "refused";
  }
  std::string text(diagnose::verdictName(diagnosis->verdict));
  for (const diagnose::EffectFinding& effect : diagnosis->effects) {
    text += fmt::format(" {}@{}{{{}}}", effect.kind, effect.joint + 1,
                        fmt::join(effect.indistinguishable_from, " "));
  }
  return text;
}

// The size that was found, or what stands against the effect: "gain 12 of 9: stability", or the doubts.
std::string remark(const std::optional<diagnose::Diagnosis>& diagnosis, const PlantedEffect& plant) {
  if (!diagnosis) {
    return {};
  }
  if (const auto size = foundSize(*diagnosis, plant)) {
    return fmt::format("{:.4g} [{:.4g} {:.4g}]", size->value, size->ci95[0], size->ci95[1]);
  }
  const std::string label = fmt::format("{}@{}", plant.kind, plant.joint + 1);
  for (const std::string& warning : diagnosis->warnings) {
    if (warning.starts_with(label)) {
      return warning;
    }
  }
  if (!diagnosis->steps.empty()) {
    for (const diagnose::CandidateScore& score : diagnosis->steps.back().ranking) {
      if (score.label == label) {
        return fmt::format("gain {:.1f} of {:.1f}: {}", score.gain, score.threshold, score.refused_because);
      }
    }
  }
  std::string doubts;
  for (const diagnose::Doubt& doubt : diagnosis->doubts) {
    doubts += fmt::format(" {}", diagnose::doubtName(doubt.kind));
  }
  return doubts;
}

class PlantedCases {
 public:
  PlantedCases(const PlantedOptions& options, std::vector<Half> halves)
      : options_(options), halves_(std::move(halves)), led_to_(halves_.size()) {
    if (!options.out.empty()) {
      std::filesystem::create_directories(options.out);
      table_.open(options.out / "planted.csv");
      table_ << "case,rig,recording,from,to,plain,planted,parameter,size,in_smallest,answer,remark\n";
    }
  }

  void run(std::size_t index) {
    Random random(options_.seed, index);
    const Half& half = withModel(random.below(halves_.size()));
    const double length = (half.to - half.from) * random.uniform(0.75, 1.0);
    const double from = half.from + random.uniform(0.0, half.to - half.from - length);
    const Recording recording = part(half.source->recording, from, from + length);
    const std::optional<diagnose::Diagnosis> plain = decide(recording, half.model);
    const std::optional<diagnose::Diagnosis> best =
        plain ? decideWithBest(recording, plain->extended) : std::nullopt;
    const std::optional<PlantedEffect> plant =
        best && !half.source->by_hand ? drawPlant(*best, recording, random) : std::nullopt;
    std::optional<diagnose::Diagnosis> answer;
    if (plant) {
      answer = diagnosePlanted(recording, best->extended, *plant);
    }
    const std::string kind = plant ? plant->kind : "nothing";
    double worst = 0.0;
    if (plain && half.other_judges) {
      for (const diagnose::EffectFinding& effect : plain->effects) {
        worst = std::max(worst, errorElsewhere(effect, plain->extended, half, recording));
      }
    }
    const bool is_false = worst > 1.0;
    const std::lock_guard lock(mutex_);
    for (Counts* counts : {&sum_, &by_rig_[half.source->rig], &by_kind_[kind]}) {
      ++counts->plain;
      counts->plain_named += plain && !plain->effects.empty() ? 1 : 0;
      counts->plain_judged += plain && half.other_judges ? 1 : 0;
      counts->plain_false += is_false ? 1 : 0;
      counts->plain_refused += plain ? 0 : 1;
      counts->nothing_shows += plain && !plant ? 1 : 0;
      if (plant) {
        mark(answer, *plant, *counts);
      }
    }
    const std::string row = fmt::format(
        "{},{},{},{:.3f},{:.3f},{},{},{},{:.4g},{:.3f},{},{}", index, half.source->rig, half.source->name,
        from, from + length,
        foundText(plain) + (is_false ? fmt::format(" FALSE: error elsewhere {:.3f} times", worst) : ""),
        plant ? fmt::format("{}@{}", plant->kind, plant->joint + 1) : "", plant ? plant->main : "",
        plant ? plant->size : 0.0, plant ? plant->in_smallest : 0.0, plant ? foundText(answer) : "",
        plant ? remark(answer, *plant) : "");
    std::fprintf(stderr, "%s\n", row.c_str());
    if (table_.is_open()) {
      table_ << row << "\n" << std::flush;
    }
  }

  std::string summary() const {
    std::string text = heading();
    for (const auto& [rig, counts] : by_rig_) {
      text += line(rig, counts);
    }
    for (const auto& [kind, counts] : by_kind_) {
      text += line(kind, counts);
    }
    return text + line("all", sum_);
  }

 private:
  // Models are worked out as they are asked for: some halves are never drawn.
  const Half& withModel(std::size_t index) {
    Half& half = halves_[index];
    std::call_once(led_to_[index], [&half] {
      const std::optional<diagnose::Diagnosis> other = decide(otherHalf(half), half.source->model);
      half.model = other ? other->extended : half.source->model;
      half.other_judges =
          other && !half.source->by_hand && other->verdict != diagnose::Verdict::kInsufficientExcitation;
    });
    return half;
  }

  static std::optional<diagnose::Diagnosis> diagnosePlanted(Recording recording,
                                                            const model::ModelDescription& best,
                                                            const PlantedEffect& plant) {
    recording.torque_timing =
        diagnose::withTorqueTiming(std::span(&recording, 1), best, {}).front().torque_timing;
    plantIn(recording, plant, model::makeModel({.mechanism = best.mechanism, .effects = {}}).mechanism());
    return decide(recording, best);
  }

  PlantedOptions options_;
  std::vector<Half> halves_;
  std::vector<std::once_flag> led_to_;  ///< its model, half by half
  std::mutex mutex_;
  std::ofstream table_;
  Counts sum_;
  std::map<std::string, Counts> by_rig_, by_kind_;
};

}  // namespace

std::string runPlanted(const PlantedOptions& options) {
  const std::vector<MeasuredRecording> all = measuredRecordings(options.data, options.source);
  PlantedCases cases(options, halvesOf(all));
  inParallel(options.threads, options.cases, [&](std::size_t index) { cases.run(options.first + index); });
  return cases.summary();
}

}  // namespace patella::bench
