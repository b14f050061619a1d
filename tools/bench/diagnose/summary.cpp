#include "tools/bench/diagnose/summary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "tools/signals/signals.hpp"

namespace patella::bench {
namespace {

using diagnose::Verdict;

constexpr double kReliable = 2.0;  // σ from which parameters are compared
constexpr double k95 = 1.959963984540054;

using Test = std::function<bool(const CaseResult&)>;

Proportion proportion(std::span<const CaseResult> results, const Test& belongs, const Test& hits) {
  Proportion result;
  for (const CaseResult& one : results) {
    if (belongs(one)) {
      ++result.cases;
      result.hits += hits(one) ? 1 : 0;
    }
  }
  return result;
}

std::string text(const Proportion& p) {
  return p.cases == 0 ? std::string("     –")
                      : fmt::format("{:3}/{:<3} {:5.1f} % ({:.1f} to {:.1f})", p.hits, p.cases,
                                    100.0 * p.share(), 100.0 * p.low(), 100.0 * p.high());
}

bool diagnosed(const CaseResult& one) {
  return one.error.empty();
}
// Of a processor, for each second of the recording and joint.
double secondsEach(const CaseResult& one) {
  return one.processor_s / (one.duration_s * static_cast<double>(one.joints));
}
Test of(Suite suite) {
  return [suite](const CaseResult& one) { return one.suite == suite && !one.truth.in_span; };
}
Test was(Outcome outcome) {
  return [outcome](const CaseResult& one) { return one.score.outcome == outcome; };
}
bool namedRight(const CaseResult& one) {
  return one.score.named_right;
}

std::string outcomes(std::span<const CaseResult> results, Suite suite) {
  std::map<Outcome, int> counts;
  int cases = 0;
  for (const CaseResult& one : results) {
    if (of(suite)(one)) {
      ++counts[one.score.outcome];
      ++cases;
    }
  }
  std::string line = fmt::format("  {:<8}{:5} cases:", suiteName(suite), cases);
  for (const auto& [outcome, count] : counts) {
    line += fmt::format("  {} {}", outcomeName(outcome), count);
  }
  return cases == 0 ? std::string() : line + "\n";
}

std::string powerText(std::span<const CaseResult> results) {
  const std::vector<double> bins = strengthBins();
  const std::vector<Proportion> power = powerCurve(results);
  std::string lines = "\nOne effect of the library, named right, by its strength in units of the noise\n";
  for (std::size_t i = 0; i < power.size(); ++i) {
    lines += fmt::format("  {:4.1f} to {:<4.1f} {}\n", bins[i], bins[i + 1], text(power[i]));
  }
  for (const char* motion : {"multisine", "gait", "sine"}) {
    lines += fmt::format("  at {:.0f} or more, {:<10} {}\n", kReliable, motion,
                         text(proportion(
                             results,
                             [&](const CaseResult& one) {
                               return of(Suite::kSingle)(one) && one.motion == motion &&
                                      one.effects[0].strength >= kReliable;
                             },
                             namedRight)));
  }
  return lines;
}

std::string confusionText(const Confusion& confusion) {
  std::string lines = "\nWhat single effects were called (columns in the order of the rows, then";
  for (std::size_t c = confusion.rows.size(); c < confusion.columns.size(); ++c) {
    lines += fmt::format(" {}{}", c + 1, " = " + confusion.columns[c]);
  }
  lines += ")\n" + std::string(29, ' ');
  for (std::size_t c = 0; c < confusion.columns.size(); ++c) {
    lines += fmt::format("{:3}", c + 1);
  }
  for (std::size_t r = 0; r < confusion.rows.size(); ++r) {
    lines += fmt::format("\n  {:2} {:<24}", r + 1, confusion.rows[r]);
    for (const std::size_t count : confusion.count[r]) {
      lines += count == 0 ? "  ." : fmt::format("{:3}", count);
    }
  }
  return lines + "\n";
}

// A line for each number of joints, where there are several or they are chains.
std::string jointsText(std::span<const CaseResult> results) {
  const auto isChain = [](const CaseResult& one) { return one.mechanism.ends_with("chain"); };
  if (std::none_of(results.begin(), results.end(), isChain)) {
    return "";
  }
  std::string lines =
      "\nChains by number of joints: an effect found where nothing is missing; one effect named right, a "
      "false\n"
      "finding; two effects named right; unknown effects called unknown; processor seconds for each second "
      "and "
      "joint\n";
  constexpr std::size_t kMost = 8;
  for (std::size_t joints = 1; joints <= kMost; ++joints) {
    const auto those = [&](Suite suite) {
      return [=](const CaseResult& one) { return isChain(one) && one.joints == joints && of(suite)(one); };
    };
    const auto share = [&](Suite suite, const Test& hits) {
      const Proportion p = proportion(results, those(suite), hits);
      return fmt::format("{:3}/{:<3}", p.hits, p.cases);
    };
    std::vector<double> seconds;
    for (const CaseResult& one : results) {
      if (isChain(one) && one.joints == joints && diagnosed(one)) {
        seconds.push_back(secondsEach(one));
      }
    }
    if (!seconds.empty()) {
      lines += fmt::format(
          "  {}: null {}  single {} false {}  double {}  unknown {}  {:.3f} s\n", joints,
          share(Suite::kNone, [](const CaseResult& one) { return !one.diagnosis.effects.empty(); }),
          share(Suite::kSingle, namedRight),
          share(Suite::kSingle, [](const CaseResult& one) { return one.score.false_findings > 0; }),
          share(Suite::kDouble, namedRight), share(Suite::kUnknown, was(Outcome::kRight)),
          offline::median(seconds));
    }
  }
  return lines;
}

std::string parameterText(std::span<const CaseResult> results) {
  std::map<std::string, std::vector<const ParameterScore*>> by_name;
  std::vector<double> all_errors;
  std::size_t covered = 0;
  for (const CaseResult& one : results) {
    const bool strong = std::all_of(one.effects.begin(), one.effects.end(),
                                    [](const CaseEffect& effect) { return effect.strength >= kReliable; });
    if (diagnosed(one) && strong) {
      for (const ParameterScore& parameter : one.score.parameters) {
        by_name[parameter.name].push_back(&parameter);
        covered += parameter.covered() ? 1 : 0;
        all_errors.push_back(parameter.relativeError());
      }
    }
  }
  if (all_errors.empty()) {
    return "";
  }
  std::string lines = fmt::format(
      "\nParameters of effects of strength {:.0f} and more that were named: median relative error, coverage "
      "of their "
      "95 % intervals\n",
      kReliable);
  for (const auto& [name, scores] : by_name) {
    std::vector<double> errors;
    std::size_t inside = 0;
    for (const ParameterScore* one : scores) {
      errors.push_back(one->relativeError());
      inside += one->covered() ? 1 : 0;
    }
    lines += fmt::format("  {:<48}{:7.1f} %  {:3}/{}\n", name, 100.0 * offline::median(errors), inside,
                         scores.size());
  }
  return lines + fmt::format("  {:<48}{:7.1f} %  {}\n", "all", 100.0 * offline::median(all_errors),
                             text({.hits = covered, .cases = all_errors.size()}));
}

std::string heldoutText(std::span<const CaseResult> results) {
  std::string lines = "\nHeld-out error in units of the true noise: median before → after, worst after\n";
  for (const Suite suite : {Suite::kNone, Suite::kSingle, Suite::kDouble, Suite::kUnknown, Suite::kDefect}) {
    std::vector<double> before, after;
    std::size_t worse = 0;
    for (const CaseResult& one : results) {
      if (diagnosed(one) && one.suite == suite && one.score.heldout_after && one.score.heldout_before) {
        before.push_back(*one.score.heldout_before);
        after.push_back(*one.score.heldout_after);
        worse += after.back() > before.back() ? 1 : 0;
      }
    }
    if (!after.empty()) {
      lines += fmt::format("  {:<8} {:7.2f} → {:5.2f}, {:6.2f}; worse than before in {} of {}\n",
                           suiteName(suite), offline::median(before), offline::median(after),
                           *std::max_element(after.begin(), after.end()), worse, after.size());
    }
  }
  return lines;
}

std::string costText(std::span<const CaseResult> results) {
  std::vector<double> simulating, diagnosing, relative;
  std::size_t failed = 0;
  for (const CaseResult& one : results) {
    failed += diagnosed(one) ? 0 : 1;
    simulating.push_back(one.simulating_s);
    diagnosing.push_back(one.diagnosing_s);
    relative.push_back(secondsEach(one));
  }
  if (simulating.empty()) {
    return "";
  }
  return fmt::format(
      "\n  seconds a case: drawing {:.2f} (median), diagnosis {:.2f} (median), {:.2f} (longest); "
      "{} diagnoses failed\n"
      "  processor seconds of diagnosis for each second of recording and joint: {:.3f} (median), {:.3f} "
      "(most)\n",
      offline::median(simulating), offline::median(diagnosing),
      *std::max_element(diagnosing.begin(), diagnosing.end()), failed, offline::median(relative),
      *std::max_element(relative.begin(), relative.end()));
}

}  // namespace

double Proportion::share() const noexcept {
  return cases == 0 ? 0.0 : static_cast<double>(hits) / static_cast<double>(cases);
}

double Proportion::low() const noexcept {
  const auto n = static_cast<double>(cases);
  const double z2 = k95 * k95;
  const double middle = (share() + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = k95 / (1.0 + z2 / n) * std::sqrt(share() * (1.0 - share()) / n + z2 / (4.0 * n * n));
  return cases == 0 ? 0.0 : std::max(0.0, middle - half);
}

double Proportion::high() const noexcept {
  const Proportion misses{.hits = cases - hits, .cases = cases};
  return cases == 0 ? 1.0 : 1.0 - misses.low();
}

std::vector<double> strengthBins() {
  return {0.4, 0.8, 1.25, 2.0, 3.2, 5.1};
}

std::vector<Proportion> powerCurve(std::span<const CaseResult> results) {
  const std::vector<double> bins = strengthBins();
  std::vector<Proportion> power;
  for (std::size_t i = 0; i + 1 < bins.size(); ++i) {
    power.push_back(proportion(
        results,
        [&](const CaseResult& one) {
          return of(Suite::kSingle)(one) && one.effects[0].strength >= bins[i] &&
                 one.effects[0].strength < bins[i + 1];
        },
        namedRight));
  }
  return power;
}

Confusion confusionOf(std::span<const CaseResult> results) {
  Confusion confusion;
  for (const KindInfo& info : allKinds()) {
    if (info.in_library) {
      confusion.rows.emplace_back(info.name);
    }
  }
  confusion.columns = confusion.rows;
  for (const char* name : {"wrong joint", "several", "unknown", "nothing", "abstained", "failed"}) {
    confusion.columns.emplace_back(name);
  }
  confusion.count.assign(confusion.rows.size(), std::vector<std::size_t>(confusion.columns.size(), 0));
  const auto columnOf = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(confusion.columns.begin(), confusion.columns.end(), name) -
                                    confusion.columns.begin());
  };
  for (const CaseResult& one : results) {
    if (one.suite != Suite::kSingle) {
      continue;
    }
    const std::string& truth = one.truth.effects[0].kind;
    std::string called = "nothing";
    if (!diagnosed(one)) {
      called = "failed";
    } else if (one.score.outcome == Outcome::kAbstained) {
      called = "abstained";
    } else if (one.score.outcome == Outcome::kUnknown) {
      called = "unknown";
    } else if (one.score.named_right || one.score.outcome == Outcome::kLargerSet) {
      called = truth;
    } else if (one.diagnosis.effects.size() > 1) {
      called = "several";
    } else if (one.diagnosis.effects.size() == 1) {
      const diagnose::EffectFinding& only = one.diagnosis.effects[0];
      called = only.kind == truth ? "wrong joint" : only.kind;
    }
    const std::size_t column = columnOf(called);
    if (column < confusion.columns.size()) {
      ++confusion.count[columnOf(truth)][column];
    }
  }
  return confusion;
}

std::string summaryText(std::span<const CaseResult> results) {
  std::string lines = "\nOutcomes\n";
  for (const Suite suite : {Suite::kNone, Suite::kSingle, Suite::kDouble, Suite::kUnknown, Suite::kDefect}) {
    lines += outcomes(results, suite);
  }
  const auto falseDiscovery = [](const CaseResult& one) { return !one.diagnosis.effects.empty(); };
  const auto falseFinding = [](const CaseResult& one) { return one.score.false_findings > 0; };
  const auto line = [&](const char* what, const Test& belongs, const Test& hits) {
    const Proportion p = proportion(results, belongs, hits);
    lines += p.cases == 0 ? std::string() : fmt::format("  {:<58}{}\n", what, text(p));
  };
  lines += "\nShares with 95 % intervals (Wilson)\n";
  line("nothing missing: an effect was found (false discovery)", of(Suite::kNone), falseDiscovery);
  line("nothing missing: called unknown", of(Suite::kNone), was(Outcome::kUnknown));
  line("one effect: named right", of(Suite::kSingle), namedRight);
  line("one effect: in a set of more than two", of(Suite::kSingle), was(Outcome::kLargerSet));
  line("one effect: a false finding", of(Suite::kSingle), falseFinding);
  line("two effects: both named right", of(Suite::kDouble), namedRight);
  line("two effects: a false finding", of(Suite::kDouble), falseFinding);
  line("unknown effect: called unknown", of(Suite::kUnknown), was(Outcome::kRight));
  line("unknown effect: called an effect of the library", of(Suite::kUnknown), falseFinding);
  line("a defect: called unknown", of(Suite::kDefect), was(Outcome::kRight));
  line("a defect: called an effect of the library", of(Suite::kDefect), was(Outcome::kFalse));
  line("a defect: nothing missing", of(Suite::kDefect), was(Outcome::kNothing));
  const auto asked = [](const CaseResult& one) {
    return diagnosed(one) && one.score.right_variable.has_value();
  };
  line("called unknown where something was missing: right variable", asked,
       [](const CaseResult& one) { return *one.score.right_variable; });
  const auto in_span = [](const CaseResult& one) { return one.truth.in_span; };
  line("taken up by nominal parameters: named, in a set or refitted", in_span, [](const CaseResult& one) {
    return one.score.named_right || one.score.outcome == Outcome::kLargerSet ||
           one.score.outcome == Outcome::kNothing;
  });
  const bool singles = std::any_of(results.begin(), results.end(),
                                   [](const CaseResult& one) { return one.suite == Suite::kSingle; });
  if (singles) {
    lines += powerText(results) + confusionText(confusionOf(results));
  }
  return lines + jointsText(results) + parameterText(results) + heldoutText(results) + costText(results);
}

}  // namespace patella::bench
