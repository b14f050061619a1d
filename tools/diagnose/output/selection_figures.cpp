#include "tools/diagnose/output/selection_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/report/palette.hpp"

namespace patella::diagnose {
namespace {

using report::Figure;

constexpr const char* kAccepted = report::colour::kGreen;
constexpr const char* kRefused = report::colour::kOrange;
constexpr const char* kWeak = report::colour::kPaleGrey;
constexpr const char* kThreshold = report::colour::kAlarm;
constexpr const char* kEstimate = report::colour::kBlack;
constexpr const char* kInterval = report::colour::kBlue;

constexpr std::size_t kShownCandidates = 12;
/// Gains that differ more than this are drawn on a logarithmic axis.
constexpr double kLinearSpan = 20.0;
/// Multiple of the largest finite gain at which a bar without end is cut off.
constexpr double kWholeAxis = 1.2;

std::string remark(const CandidateScore& score) {
  const std::string gain =
      score.gain < 99.5 ? fmt::format("{:.3g}", score.gain) : fmt::format("{:.0f}", score.gain);
  if (score.accepted) {
    return gain + "  accepted";
  }
  return score.refused_because.empty() ? gain : gain + "  refused: " + score.refused_because;
}

Figure rankingFigure(const SelectionStep& step, std::size_t number) {
  Figure figure;
  figure.section =
      "Candidates, step by step (green: accepted; amber: more than chance; grey: no more; red: what chance "
      "reaches)";
  figure.title = step.accepted.empty() ? fmt::format("Step {}: none accepted", number)
                                       : fmt::format("Step {}: {} accepted, p = {:.2g}", number,
                                                     effectWords(step.accepted), step.p_value);
  figure.x_label = "gain / nats of log-likelihood";
  const std::size_t shown = std::min(step.ranking.size(), kShownCandidates);
  double highest = 1.0;
  double lowest_mark = 1e300;
  for (std::size_t row = 0; row < shown; ++row) {
    const CandidateScore& score = step.ranking[row];
    highest = std::max(highest, score.threshold);
    // A fit that leaves nothing gains without end.
    if (std::isfinite(score.gain)) {
      highest = std::max(highest, score.gain);
    }
    if (score.threshold > 0.0) {
      lowest_mark = std::min(lowest_mark, score.threshold);
    }
  }
  figure.log_x = lowest_mark < highest / kLinearSpan;
  const double start = figure.log_x ? std::min(1.0, 0.5 * lowest_mark) : 0.0;
  for (std::size_t row = 0; row < shown; ++row) {
    const CandidateScore& score = step.ranking[row];
    const double gain = std::clamp(score.gain, start, kWholeAxis * highest);
    figure.rows.push_back(effectWords(score.label));
    figure.bars.push_back({.row = row,
                           .from = start,
                           .to = gain,
                           .colour = score.accepted                 ? kAccepted
                                     : score.gain > score.threshold ? kRefused
                                                                    : kWeak});
    if (score.threshold > 0.0) {
      figure.row_marks.push_back({.row = row, .at = score.threshold, .colour = kThreshold});
    }
    figure.row_notes.push_back({.row = row, .at = std::max(gain, score.threshold), .text = remark(score)});
  }
  for (double tick = 1.0; figure.log_x && tick <= 1.01 * highest; tick *= 10.0) {
    figure.x_ticks.push_back(tick);
  }
  // Room for the words behind the longest bar.
  figure.x_range = {start, figure.log_x ? start * std::pow(highest / start, 2.3) : 2.5 * highest};
  if (step.ranking.size() > shown) {
    figure.x_label += fmt::format("; {} weaker ones left out", step.ranking.size() - shown);
  }
  return figure;
}

struct Row {
  std::string name;
  std::array<double, 2> interval_percent;  ///< of the estimate, from it
  std::array<double, 2> range_percent;
  std::string text;
  bool twice;  ///< among the diagnosis' runaways
};

bool isRunaway(const Diagnosis& diagnosis, const std::string& what) {
  return std::any_of(diagnosis.runaways.begin(), diagnosis.runaways.end(),
                     [&](const Runaway& runaway) { return runaway.what == what; });
}

Row rowOf(const Diagnosis& diagnosis, const EffectFinding& effect, const ParameterEstimate& estimate) {
  const Units units = unitsOf(diagnosis, effect.joint);
  const ParameterName name = splitName(estimate.name, units);
  const std::array<double, 2> range = physicalRange(effect.kind, estimate.name);
  // An estimate of nothing is compared with its own interval.
  const double half = 0.5 * (estimate.ci95[1] - estimate.ci95[0]);
  const double unit = 0.01 * std::max({std::abs(estimate.value), 0.1 * half, 1e-12});
  const auto percent = [&](double value) { return (value - estimate.value) / unit; };
  return {
      .name = effectWords(effect) + ": " + name.words,
      .interval_percent = {percent(estimate.ci95[0]), percent(estimate.ci95[1])},
      .range_percent = {percent(range[0]), percent(range[1])},
      .text = fmt::format("{} {}   (physical: {:.4g} … {:.4g})",
                          valueWithInterval(estimate.value, estimate.ci95), name.unit, range[0], range[1]),
      .twice = isRunaway(diagnosis, fmt::format("{}@{} {}", effect.kind, effect.joint + 1, estimate.name))};
}

/// 1, 2 or 5 times a power of ten, two to five of them in the span.
double niceStep(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span)));
  const double digits = span / power;
  return power * (digits < 2.0 ? 0.5 : digits < 5.0 ? 1.0 : 2.0);
}

std::vector<Figure> parameterFigures(const Diagnosis& diagnosis) {
  std::vector<Row> rows;
  for (const EffectFinding& effect : diagnosis.effects) {
    for (const ParameterEstimate& estimate : effect.parameters) {
      rows.push_back(rowOf(diagnosis, effect, estimate));
    }
  }
  if (rows.empty()) {
    return {};
  }
  double widest = 1.0;
  for (const Row& row : rows) {
    for (const double end : row.interval_percent) {
      if (std::isfinite(end)) {
        widest = std::max(widest, std::abs(end));
      }
    }
  }
  constexpr double kWidest_percent = 150.0;
  const double side = 1.15 * std::min(widest, kWidest_percent);
  Figure figure;
  figure.section = "Parameters found, with 95 % intervals";
  figure.title =
      "Distance from the estimate (blue: 95 % interval; amber: to look at twice; red: end of the physical "
      "range)";
  figure.x_label = "% of the estimate";
  figure.wide = true;
  figure.x_range = {-side, 2.6 * side};
  const double step = niceStep(side);
  for (double tick = 0.0; tick <= side; tick += step) {
    figure.x_ticks.push_back(tick);
    figure.x_ticks.push_back(-tick);
  }
  figure.levels = {{.value = 0.0, .label = {}, .vertical = true}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    figure.rows.push_back(row.name);
    figure.bars.push_back({.row = i,
                           .from = std::max(-side, row.interval_percent[0]),
                           .to = std::min(side, row.interval_percent[1]),
                           .colour = row.twice ? kRefused : kInterval});
    figure.row_marks.push_back({.row = i, .at = 0.0, .colour = kEstimate});
    for (const double end : row.range_percent) {
      if (std::abs(end) < side) {
        figure.row_marks.push_back({.row = i, .at = end, .colour = kThreshold});
      }
    }
    figure.row_notes.push_back({.row = i, .at = 1.05 * side, .text = row.text});
  }
  return {figure};
}

}  // namespace

std::vector<Figure> selectionFigures(const Diagnosis& diagnosis) {
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < diagnosis.steps.size(); ++i) {
    if (!diagnosis.steps[i].ranking.empty()) {
      figures.push_back(rankingFigure(diagnosis.steps[i], i + 1));
    }
  }
  for (Figure& figure : parameterFigures(diagnosis)) {
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace patella::diagnose
