#include "tools/diagnose/output/power_figures.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/power.hpp"
#include "tools/report/palette.hpp"

namespace patella::diagnose {
namespace {

using report::Figure;

constexpr const char* kShows = report::colour::kGreen;
constexpr const char* kWeak = report::colour::kPaleGrey;

// Smallest torque of each effect that would have been revealed, over its joint's torque.
Figure powerFigure(const Diagnosis& diagnosis, int joint) {
  constexpr double kMost_percent = 1000.0;
  Figure figure;
  figure.section = "What this recording would have revealed (grey: more than a fifth of the joint's torque)";
  figure.title =
      fmt::format("Joint {}: smallest torque of each effect, in four of five recordings", joint + 1);
  figure.x_label = "smallest torque / % of the joint's torque (rms)";
  figure.log_x = true;
  double lowest = 1.0, highest = 10.0;
  for (const Revealed& revealed : diagnosis.revealed) {
    if (revealed.joint != joint) {
      continue;
    }
    const double percent = std::min(kPercent * revealed.share_of_torque, kMost_percent);
    const std::size_t row = figure.rows.size();
    const std::string name = effectWords(revealed.kind);
    figure.rows.push_back(name);
    lowest = std::min(lowest, percent);
    highest = std::max(highest, percent);
    figure.bars.push_back({.row = row,
                           .from = 0.0,
                           .to = percent,
                           .colour = revealed.share_of_torque > unknown::kMaterialRest ? kWeak : kShows});
    figure.row_notes.push_back(
        {.row = row, .at = percent, .text = sizeWords(revealed, unitsOf(diagnosis, revealed.joint))});
  }
  const double start = std::pow(10.0, std::floor(std::log10(std::max(lowest, 1e-3))));
  for (auto& bar : figure.bars) {
    bar.from = start;
    bar.to = std::max(bar.to, start);
  }
  for (double tick = start; tick <= 1.01 * highest; tick *= 10.0) {
    figure.x_ticks.push_back(tick);
  }
  figure.x_range = {start, start * std::pow(highest / start, 1.5)};
  return figure;
}

}  // namespace

std::vector<Figure> powerFigures(const Diagnosis& diagnosis) {
  std::vector<Figure> figures;
  for (std::size_t joint = 0; joint < diagnosis.rests.size(); ++joint) {
    Figure figure = powerFigure(diagnosis, static_cast<int>(joint));
    if (!figure.rows.empty()) {
      figures.push_back(std::move(figure));
    }
  }
  return figures;
}

}  // namespace patella::diagnose
