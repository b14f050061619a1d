#include "tools/bench/faults/table.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace patella::bench {
namespace {

constexpr std::size_t kMostFindings = 20;

struct Row {
  int runs = 0;
  int owed = 0;
  double worst_s = -1.0;
  double worst_budget_s = 0.0;
  std::uint64_t worst_seed = 0;
};

std::string describe(const sim::FaultEvent& event) {
  return fmt::format(
      "{} at {:.3f} s for {:.3f} s{}{}, channel {}, p {:.3g}, value {:.4g}", faultKindName(event.kind),
      event.time_s, event.duration_s,
      event.cycle_s > 0.0
          ? fmt::format(", {:.0f} % of every {:.1f} ms", 100.0 * event.duty, 1e3 * event.cycle_s)
          : "",
      event.stage ? fmt::format(", at stage '{}'", tick::kStageNames[static_cast<std::size_t>(*event.stage)])
                  : "",
      event.channel, event.probability, event.value);
}

std::string finding(const TrialResult& result) {
  std::string text;
  if (result.limit_violations > 0) {
    text += fmt::format(" {} commands beyond a limit", result.limit_violations);
  }
  if (result.unlatched > 0) {
    text += fmt::format(" {} enabling commands after a fault", result.unlatched);
  }
  if (!result.was_active || result.stopped_before) {
    text += " stopped without a fault, or never began";
  }
  for (const Reaction& reaction : result.reactions) {
    if (reaction.late) {
      text += fmt::format(" {} not stopped in time: {:.1f} ms of {:.1f}", faultKindName(reaction.kind),
                          1e3 * reaction.taken_s, 1e3 * reaction.budget_s);
    }
  }
  if (text.empty()) {
    return text;
  }
  text =
      fmt::format("seed {}:{}; first cause {}\n", result.seed, text, safety::faultName(result.first_cause));
  for (const sim::FaultEvent& event : result.faults) {
    text += "    " + describe(event) + "\n";
  }
  return text;
}

}  // namespace

std::string report(const std::vector<TrialResult>& results) {
  std::vector<Row> rows(sim::kFaultKindCount);
  int singles = 0;
  for (const TrialResult& result : results) {
    singles += result.faults.size() == 1 ? 1 : 0;
    for (const sim::FaultEvent& event : result.faults) {
      ++rows[static_cast<std::size_t>(event.kind)].runs;
    }
    for (const Reaction& reaction : result.reactions) {
      Row& row = rows[static_cast<std::size_t>(reaction.kind)];
      ++row.owed;
      if (result.faults.size() == 1 && reaction.taken_s > row.worst_s) {
        row.worst_s = reaction.taken_s;
        row.worst_budget_s = reaction.budget_s;
        row.worst_seed = result.seed;
      }
    }
  }
  std::string text = fmt::format("{} runs, {} with one fault and {} with two\n\n", results.size(), singles,
                                 static_cast<int>(results.size()) - singles);
  text += fmt::format("{:<22}{:>7}{:>12}{:>12}{:>12}{:>12}\n", "fault", "runs", "stop owed", "worst, ms",
                      "budget, ms", "seed");
  for (int i = 0; i < sim::kFaultKindCount; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    if (row.runs == 0) {
      continue;
    }
    text +=
        fmt::format("{:<22}{:>7}{:>12}", faultKindName(static_cast<sim::FaultKind>(i)), row.runs, row.owed);
    text += row.worst_s >= 0.0 ? fmt::format("{:>12.1f}{:>12.1f}{:>12}\n", 1e3 * row.worst_s,
                                             1e3 * row.worst_budget_s, row.worst_seed)
                               : fmt::format("{:>12}{:>12}{:>12}\n", "–", "–", "–");
  }
  const Verdict verdict = judge(results);
  text += fmt::format(
      "\nlimit violations {}, unlatched {}, late or missing reactions {}, stops without a fault {}\n",
      verdict.limit_violations, verdict.unlatched, verdict.late, verdict.spurious);
  std::size_t shown = 0;
  for (const TrialResult& result : results) {
    const std::string found = finding(result);
    if (!found.empty() && shown++ < kMostFindings) {
      text += found;
    }
  }
  return text;
}

}  // namespace patella::bench
