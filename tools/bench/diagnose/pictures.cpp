#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/bench/diagnose/summary.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"

namespace patella::bench {
namespace {

using report::colour::kBlue;
using report::colour::kGrey;

report::Series curve(const std::string& label, const char* colour, double width) {
  report::Series series;
  series.label = label;
  series.colour = colour;
  series.width = width;
  return series;
}

report::Figure powerFigure(std::span<const CaseResult> results) {
  const std::vector<double> bins = strengthBins();
  const std::vector<Proportion> power = powerCurve(results);
  report::Figure figure;
  figure.title = "One effect of the library: how often it is named right";
  figure.x_label = "strength of the effect / rms of the noise below 10 Hz";
  figure.y_label = "share / %";
  figure.x_range = {0.0, bins.back()};
  figure.wide = true;
  report::Series share = curve("named right, with 95 % intervals", kBlue, 2.0);
  report::Series low = curve("", kGrey, 1.0);
  report::Series high = low;
  for (std::size_t i = 0; i < power.size(); ++i) {
    if (power[i].cases > 0) {
      for (report::Series* series : {&share, &low, &high}) {
        series->x.push_back(std::sqrt(bins[i] * bins[i + 1]));
      }
      share.y.push_back(100.0 * power[i].share());
      low.y.push_back(100.0 * power[i].low());
      high.y.push_back(100.0 * power[i].high());
    }
  }
  // Unseen, it keeps the whole range in the picture.
  report::Series range = curve("", report::colour::kWhite, 0.1);
  range.x = {0.0, 0.0};
  range.y = {0.0, 100.0};
  report::Series dots = share;
  dots.label.clear();
  dots.points = true;
  report::Series bounds = low;
  bounds.points = true;
  bounds.x.insert(bounds.x.end(), high.x.begin(), high.x.end());
  bounds.y.insert(bounds.y.end(), high.y.begin(), high.y.end());
  figure.series = {share, dots, low, high, bounds, range};
  return figure;
}

// White to dark blue.
std::string shade(double share) {
  const auto channel = [share](double full) {
    return static_cast<int>(std::lround(255.0 + share * (full - 255.0)));
  };
  return fmt::format("#{:02X}{:02X}{:02X}", channel(8.0), channel(48.0), channel(107.0));
}

// The part of a name that fits beside the picture.
std::string shortened(std::string kind) {
  for (const std::string part : {"_friction", "_moment", "transmission_"}) {
    const std::size_t place = kind.find(part);
    if (place != std::string::npos) {
      kind.erase(place, part.size());
    }
  }
  std::replace(kind.begin(), kind.end(), '_', ' ');
  return kind;
}

// A row of cells for each kind; columns carry the numbers of the rows, and those beyond them their names'
// numbers.
report::Figure confusionFigure(const Confusion& confusion) {
  report::Figure figure;
  figure.title = "What an effect was called: share of its cases, white none, dark all";
  const std::size_t kinds = confusion.rows.size();
  figure.x_label =
      fmt::format("called: number as at the left; {} to {}: {}", kinds + 1, confusion.columns.size(),
                  fmt::join(confusion.columns.begin() + static_cast<std::ptrdiff_t>(kinds),
                            confusion.columns.end(), ", "));
  figure.x_range = {0.5, static_cast<double>(confusion.columns.size()) + 0.5};
  figure.wide = true;
  for (std::size_t r = 0; r < kinds; ++r) {
    figure.rows.push_back(fmt::format("{} {}", shortened(confusion.rows[r]), r + 1));
    std::size_t all = 0;
    for (const std::size_t count : confusion.count[r]) {
      all += count;
    }
    for (std::size_t c = 0; c < confusion.columns.size(); ++c) {
      if (confusion.count[r][c] > 0) {
        const double place = static_cast<double>(c) + 1.0;
        figure.bars.push_back(
            {.row = r,
             .from = place - 0.45,
             .to = place + 0.45,
             .colour = shade(static_cast<double>(confusion.count[r][c]) / static_cast<double>(all))});
      }
    }
  }
  return figure;
}

}  // namespace

void drawSummary(std::span<const CaseResult> results, const std::filesystem::path& folder) {
  const bool singles = std::any_of(results.begin(), results.end(), [](const CaseResult& one) {
    return one.error.empty() && one.suite == Suite::kSingle;
  });
  if (singles) {
    const report::Figure power = powerFigure(results);
    report::drawPng(std::span(&power, 1), "Diagnosis of simulated rigs", folder / "power.png");
    const report::Figure confusion = confusionFigure(confusionOf(results));
    report::drawPng(std::span(&confusion, 1), "Diagnosis of simulated rigs", folder / "confusion.png");
  }
}

}  // namespace patella::bench
