#include "tools/diagnose/output/answer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ostream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/verdict/power.hpp"

namespace patella::diagnose {
namespace {

constexpr std::size_t kShownEffects = 4;
constexpr std::size_t kShownRunaways = 4;
constexpr std::size_t kShownRefused = 3;
constexpr std::size_t kShownWarnings = 3;
constexpr std::chrono::seconds kSilence{10};

std::string effectLine(const EffectFinding& effect, const Units& units) {
  std::string line = "  " + effectWords(effect);
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    line += (i == 0 ? ": " : ", ") + estimateText(effect.parameters[i], units);
  }
  line += torqueErrorText(effect) + (effect.p_value ? fmt::format(" (p = {:.2g})", *effect.p_value) : "");
  for (std::size_t i = 0; i < effect.indistinguishable_from.size(); ++i) {
    line += (i == 0 ? "; or " : ", ") + effectWords(effect.indistinguishable_from[i]);
  }
  if (!effect.asserted()) {
    line += "; possibly: " + effect.not_asserted_because;
  }
  for (std::size_t i = 0; i < effect.replaces.size(); ++i) {
    line += (i == 0 ? "; in place of the declared " : " and ") + effectWords(effect.replaces[i]);
  }
  return line;
}

// Candidates that would have explained as much as the accepted one, or more than chance, but for their sign:
// each kind once, where it would have explained most, and those that would have explained most of all.
std::vector<std::string> refusedLines(const Diagnosis& diagnosis) {
  std::map<std::string, std::pair<double, std::string>> refused;
  for (std::size_t number = 0; number < diagnosis.steps.size(); ++number) {
    const SelectionStep& step = diagnosis.steps[number];
    double accepted = 0.0;
    for (const CandidateScore& score : step.ranking) {
      accepted = score.accepted ? score.gain : accepted;
    }
    for (const CandidateScore& score : step.ranking) {
      constexpr std::string_view kSign = "sign: ";
      constexpr double kComparable = 0.5;
      auto& known = refused[score.label];
      if (score.refused_because.starts_with(kSign) && score.gain > known.first &&
          score.gain > score.threshold && score.gain > kComparable * accepted) {
        // No drive acts before its command.
        const bool late =
            score.label.starts_with("actuator_delay") || score.label.starts_with("actuator_lag");
        known = {score.gain,
                 fmt::format("  refused for its sign: {} ({} would be negative; {:.0f} nats in step {}){}",
                             effectWords(score.label), score.refused_because.substr(kSign.size()), score.gain,
                             number + 1, late ? ": a torque column that comes late looks like this" : "")};
      }
    }
  }
  std::vector<std::pair<double, std::string>> sorted;
  for (auto& [label, entry] : refused) {
    if (!entry.second.empty()) {
      sorted.push_back(std::move(entry));
    }
  }
  std::sort(sorted.rbegin(), sorted.rend());
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < std::min(sorted.size(), kShownRefused); ++i) {
    lines.push_back(std::move(sorted[i].second));
  }
  if (sorted.size() > kShownRefused) {
    lines.back() += fmt::format("; and {} more in the report", sorted.size() - kShownRefused);
  }
  return lines;
}

std::string errorLine(const Diagnosis& diagnosis, std::size_t joint) {
  const bool heldout = joint < diagnosis.before.heldout_rms_Nm.size();
  const auto rms = [&](const ErrorMeasure& error) {
    return numberAt(heldout ? error.heldout_rms_Nm : error.train_rms_Nm, joint);
  };
  return fmt::format("  error of joint {}{}, {}: {} as given, {} refitted, {} extended; noise floor {}",
                     joint + 1, heldout ? " on held-out data" : "",
                     unitsOf(diagnosis, static_cast<int>(joint)).torque, rms(diagnosis.before),
                     rms(diagnosis.refitted), rms(diagnosis.after),
                     numberAt(diagnosis.noise_floor_Nm, joint));
}

void printEffects(const Diagnosis& diagnosis, std::ostream& out) {
  // Asserted ones first, and all of them.
  std::vector<EffectFinding> effects;
  for (const bool asserted : {true, false}) {
    std::copy_if(diagnosis.effects.begin(), diagnosis.effects.end(), std::back_inserter(effects),
                 [=](const EffectFinding& effect) { return effect.asserted() == asserted; });
  }
  const auto asserted = static_cast<std::size_t>(std::count_if(
      effects.begin(), effects.end(), [](const EffectFinding& effect) { return effect.asserted(); }));
  const std::size_t shown = std::min(effects.size(), std::max(kShownEffects, asserted));
  for (std::size_t i = 0; i < shown; ++i) {
    out << effectLine(effects[i], unitsOf(diagnosis, effects[i].joint)) << "\n";
  }
  if (effects.size() > shown) {
    out << "  and " << effects.size() - shown << " more that are possible, in the report\n";
  }
}

}  // namespace

void printAnswer(const Diagnosis& diagnosis, const std::filesystem::path& folder, std::ostream& out) {
  out << verdictWords(diagnosis.verdict) << ". " << diagnosis.explanation << "\n";
  printEffects(diagnosis, out);
  for (const std::string& line : refusedLines(diagnosis)) {
    out << line << "\n";
  }
  const RevealedWords revealed = revealedWords(diagnosis);
  for (const auto& [words, effects] : {std::pair("would have shown", revealed.shown),
                                       std::pair("would not show at any size", revealed.hidden)}) {
    if (!effects.empty()) {
      out << "  " << words << ": " << effects << "\n";
    }
  }
  if (!diagnosis.plan_command.empty()) {
    out << "  a motion that would tell, within the limits of the loop's configuration CONFIG:\n    "
        << diagnosis.plan_command << "\n";
  }
  for (std::size_t joint = 0; joint < diagnosis.before.train_rms_Nm.size(); ++joint) {
    out << errorLine(diagnosis, joint) << "\n";
  }
  const std::size_t twice = std::min(diagnosis.runaways.size(), kShownRunaways);
  for (std::size_t i = 0; i < twice; ++i) {
    const std::size_t more = i + 1 == twice ? diagnosis.runaways.size() - twice : 0;
    out << "  to look at twice: " << diagnosis.runaways[i].words
        << (more > 0 ? fmt::format("; and {} more in the report", more) : "") << "\n";
  }
  const std::size_t warned = std::min(diagnosis.warnings.size(), kShownWarnings);
  for (std::size_t i = 0; i < warned; ++i) {
    const std::size_t more = i + 1 == warned ? diagnosis.warnings.size() - warned : 0;
    out << "  warning: " << diagnosis.warnings[i]
        << (more > 0 ? fmt::format("; and {} more in the report", more) : "") << "\n";
  }
  out << "  files in " << folder.string() << ": report.html, diagnosis.json, model.extended.toml\n";
}

void ProgressLine::at(std::string_view stage, double fraction) {
  const int percent = static_cast<int>(std::lround(kPercent * std::clamp(fraction, 0.0, 1.0)));
  const bool new_stage = stage != stage_;
  const auto now = now_();
  if (!new_stage && (terminal_ ? percent == percent_ : now - said_ < kSilence)) {
    return;
  }
  stage_ = stage;
  percent_ = percent;
  said_ = now;
  if (terminal_) {
    out_ << fmt::format("\r\033[K{} {} %", stage_, percent_) << std::flush;
  } else {
    out_ << stage_ << (new_stage ? "" : fmt::format(" {} %", percent_)) << "\n" << std::flush;
  }
}

void ProgressLine::clear() {
  if (terminal_ && percent_ >= 0) {
    out_ << "\r\033[K" << std::flush;
    percent_ = -1;
  }
}

}  // namespace patella::diagnose
