#include "tools/studies/paper/paper_tables.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::study {
namespace {

/// One estimator in one condition.
struct Entry {
  Condition condition;
  std::string name;
  std::string kind;
  std::size_t seeds = 0;
  std::array<Spread, 2> error;
};

bool sameCondition(const Condition& a, const Condition& b) {
  return a.experiment == b.experiment && a.corrected == b.corrected;
}

const char* kindName(Method::Kind kind) {
  return kind == Method::Kind::kCausal ? "causal" : kind == Method::Kind::kDelayed ? "delayed" : "offline";
}

constexpr const char* kTarget = "what the network learned from";
constexpr const char* kNothing = "saying nothing";

/// Statistics over the seeds of a condition's networks; `value` picks what is looked at.
template <typename Value>
Entry entryOf(const PaperResults& results, const Condition& condition, const std::string& tested_on,
              const std::string& name, Value value) {
  std::array<std::vector<double>, 2> errors;
  for (const NetworkCase& one : results.networks) {
    for (const NetworkScore& score : one.scores) {
      if (sameCondition(one.condition, condition) && score.tested_on == tested_on) {
        errors[0].push_back(value(score)[0]);
        errors[1].push_back(value(score)[1]);
      }
    }
  }
  return {condition, name, "causal", errors[0].size(), {spreadOf(errors[0]), spreadOf(errors[1])}};
}

std::vector<std::string> testsOf(const PaperResults& results) {
  std::vector<std::string> tests;
  for (const NetworkCase& one : results.networks) {
    for (const NetworkScore& score : one.scores) {
      if (std::find(tests.begin(), tests.end(), score.tested_on) == tests.end()) {
        tests.push_back(score.tested_on);
      }
    }
  }
  return tests;
}

std::vector<Condition> conditionsOf(const PaperResults& results) {
  std::vector<Condition> conditions;
  const auto add = [&](const Condition& condition) {
    if (std::none_of(conditions.begin(), conditions.end(),
                     [&](const Condition& known) { return sameCondition(known, condition); })) {
      conditions.push_back(condition);
    }
  };
  for (const Result& result : results.observers) {
    add(result.condition);
  }
  for (const NetworkCase& one : results.networks) {
    add(one.condition);
  }
  return conditions;
}

std::vector<Entry> entriesOf(const PaperResults& results) {
  std::vector<Entry> entries;
  for (const Condition& condition : conditionsOf(results)) {
    for (const Result& result : results.observers) {
      if (sameCondition(result.condition, condition)) {
        entries.push_back({condition, result.method->name, kindName(result.method->kind),
                           static_cast<std::size_t>(results.observer_seeds), result.error});
      }
    }
    const std::vector<std::string> tests = testsOf(results);
    for (const std::string& test : tests) {
      entries.push_back(entryOf(results, condition, test, "network, " + test,
                                [](const NetworkScore& score) { return score.network; }));
    }
    if (!tests.empty()) {
      entries.push_back(entryOf(results, condition, tests.front(), kTarget,
                                [](const NetworkScore& score) { return score.target; }));
      entries.back().kind = "offline";
      entries.push_back(entryOf(results, condition, tests.front(), kNothing,
                                [](const NetworkScore& score) { return score.nothing; }));
    }
  }
  std::erase_if(entries, [](const Entry& entry) { return entry.seeds == 0; });
  return entries;
}

std::string cell(const Entry& entry) {
  return entry.seeds == 1
             ? fmt::format("{:.4f} / {:.4f}", entry.error[0].mean, entry.error[1].mean)
             : fmt::format("{:.4f} ± {:.4f} / {:.4f} ± {:.4f}", entry.error[0].mean, entry.error[0].deviation,
                           entry.error[1].mean, entry.error[1].deviation);
}

std::string formTable(const std::vector<Entry>& entries, bool corrected) {
  std::string text = fmt::format(
      "\n{}: mean error in {}, joint 1 / joint 2, ± standard deviation over seeds\n\n"
      "| | | seeds | experiment 1 | experiment 2 |\n|---|---|---|---|---|\n",
      corrected ? "Corrected (f_u = I⁻¹ Jᵀ h, the leg under position control)"
                : "As printed (f_u = J h taken as acceleration)",
      corrected ? "N·m" : "rad/s²");
  if (!corrected) {
    text +=
        "| *the paper: its network* | | 1 | 0.0235 / 0.0362, experiment not said | |\n"
        "| *the paper: its ITSMC* | | 1 | 0.0241 / 0.0483, experiment not said | |\n";
  }
  std::vector<std::string> done;
  for (const Entry& row : entries) {
    if (row.condition.corrected != corrected || std::find(done.begin(), done.end(), row.name) != done.end()) {
      continue;
    }
    done.push_back(row.name);
    std::array<std::string, 2> cells;
    for (const Entry& entry : entries) {
      if (entry.condition.corrected == corrected && entry.name == row.name) {
        cells[entry.condition.experiment == sim::PaperExperiment::kFirst ? 0 : 1] = cell(entry);
      }
    }
    text += fmt::format("| {} | {} | {} | {} | {} |\n", row.name, row.kind, row.seeds, cells[0], cells[1]);
  }
  return text;
}

double sumOf(const Entry& entry) {
  return entry.error[0].mean + entry.error[1].mean;
}

/// Mean of both joints' mean errors.
std::string both(const Entry& entry) {
  return fmt::format("{:.4f}", 0.5 * sumOf(entry));
}

}  // namespace

std::string table1(const PaperResults& results) {
  const std::vector<Entry> entries = entriesOf(results);
  std::string text;
  for (const bool corrected : {false, true}) {
    if (std::any_of(entries.begin(), entries.end(),
                    [&](const Entry& entry) { return entry.condition.corrected == corrected; })) {
      text += formTable(entries, corrected);
    }
  }
  return text;
}

void writeTable1(const PaperResults& results, const std::filesystem::path& path) {
  std::string text = "form,experiment,method,kind,seeds,unit,joint,error_mean,error_sd\n";
  for (const Entry& entry : entriesOf(results)) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      text += fmt::format("{},{},\"{}\",{},{},{},{},{:.6g},{:.6g}\n",
                          entry.condition.corrected ? "corrected" : "as_printed",
                          numberOf(entry.condition.experiment), entry.name, entry.kind, entry.seeds,
                          entry.condition.corrected ? "N·m" : "rad/s²", joint + 1, entry.error[joint].mean,
                          entry.error[joint].deviation);
    }
  }
  app::writeFile(path, text);
}

std::string meaning(const PaperResults& results) {
  std::string text =
      "What this means: time is one of the network's inputs. In the random split every tested step stands "
      "between "
      "trained\nones, 10 ms away at 100 Hz, so that a curve through the trained steps hits it; that is "
      "smoothing, with "
      "the future in\nsight, and the offline smoother, which learned nothing, does it better. Blocked and "
      "chronological "
      "leave out what the\ntimetable says of 5 s, or of half the recording: what the network says there is a "
      "guess. On "
      "another motion it is good as\nfar as the push keeps the timetable that was learned, and not where the "
      "same push has "
      "begun a little earlier. Nothing of this\ncan be used on a patient, whose pushes keep no timetable. "
      "The observers' "
      "errors are the same on any motion.\n\nMean of both joints:\n";
  const std::vector<Entry> entries = entriesOf(results);
  for (const Condition& condition : conditionsOf(results)) {
    text += fmt::format("  experiment {}, {}:", numberOf(condition.experiment), formName(condition));
    const Entry* best = nullptr;
    for (const Entry& entry : entries) {
      if (!sameCondition(entry.condition, condition)) {
        continue;
      }
      const bool of_network =
          entry.name.starts_with("network") || entry.name == kTarget || entry.name == kNothing;
      if (of_network) {
        text += fmt::format(" {} {};", entry.name, both(entry));
      } else if (entry.kind == "causal" && (best == nullptr || sumOf(entry) < sumOf(*best))) {
        best = &entry;
      }
    }
    text += best == nullptr ? "\n" : fmt::format(" best causal observer ({}) {}\n", best->name, both(*best));
  }
  return text;
}

}  // namespace patella::study
