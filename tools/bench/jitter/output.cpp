#include "tools/bench/jitter/output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"

namespace patella::bench {
namespace {

constexpr std::array kQuantiles{0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999};

std::string row(const std::string& condition, const char* program, const Distribution& distribution) {
  std::string text = fmt::format("{:<8} {:<11}{:>10}", condition, program, distribution.count());
  for (const double quantile : kQuantiles) {
    // A quantile that no wake-up lies above is the maximum.
    const bool known = std::round((1.0 - quantile) * static_cast<double>(distribution.count())) >= 1.0;
    text += known ? fmt::format("{:>9.1f}", distribution.quantile_us(quantile)) : fmt::format("{:>9}", "-");
  }
  return text + fmt::format("{:>10.1f}\n", distribution.maximum_us());
}

Distribution pooled(const std::vector<Turn>& turns, Distribution Turn::*program) {
  Distribution result;
  for (const Turn& turn : turns) {
    result.merge(turn.*program);
  }
  return result;
}

report::Series laterThan(const Distribution& distribution, const char* label, const char* colour) {
  report::Series series;
  series.label = label;
  series.colour = colour;
  series.steps = true;
  std::uint64_t seen = 0;
  for (const auto& [upper_us, count] : distribution.buckets()) {
    seen += count;
    if (seen < distribution.count()) {
      series.x.push_back(upper_us);
      series.y.push_back(static_cast<double>(distribution.count() - seen) /
                         static_cast<double>(distribution.count()));
    }
  }
  return series;
}

}  // namespace

std::string table(const std::vector<Comparison>& comparisons) {
  std::string text = fmt::format("{:<8} {:<11}{:>10}", "wake-up", "latency, µs", "count");
  for (const char* name : {"p50", "p90", "p99", "p99.9", "p99.99", "p99.999"}) {
    text += fmt::format("{:>9}", name);
  }
  text += fmt::format("{:>10}\n", "max");
  for (const Comparison& one : comparisons) {
    const Distribution cyclictest = pooled(one.turns, &Turn::cyclictest);
    text += row(one.condition, "loop", pooled(one.turns, &Turn::loop)) +
            row(one.condition, "cyclictest", cyclictest);
    if (cyclictest.beyond() > 0) {
      text += fmt::format("{:<8} {} of cyclictest's beyond 1 ms, counted at the maximum\n", one.condition,
                          cyclictest.beyond());
    }
    const Ratio ratio = ratioOfP999(one.turns);
    text += fmt::format(
        "{:<8} loop's p99.9 is {:.2f} times cyclictest's ({:.2f} to {:.2f}, 95 % over {} turns)\n",
        one.condition, ratio.all, ratio.low, ratio.high, one.turns.size());
  }
  return text;
}

void draw(const std::vector<Comparison>& comparisons, const std::filesystem::path& picture) {
  std::vector<report::Figure> figures;
  for (const Comparison& one : comparisons) {
    report::Figure figure;
    figure.title = one.condition;
    figure.wide = comparisons.size() == 1;
    figure.x_label = "latency / µs";
    figure.y_label = "fraction of wake-ups later";
    figure.log_x = true;
    figure.log_y = true;
    figure.series = {laterThan(pooled(one.turns, &Turn::loop), "loop", report::colour::kBlue),
                     laterThan(pooled(one.turns, &Turn::cyclictest), "cyclictest", report::colour::kRed)};
    figures.push_back(std::move(figure));
  }
  report::drawPng(figures, "Wake-up latency of the loop beside cyclictest's, same run and priority", picture);
}

void writeCsv(const std::vector<Comparison>& comparisons, const std::filesystem::path& path) {
  std::string text = "condition,program,upper_us,count\n";
  for (const Comparison& one : comparisons) {
    for (const auto& [program, distribution] :
         {std::pair{"loop", pooled(one.turns, &Turn::loop)},
          std::pair{"cyclictest", pooled(one.turns, &Turn::cyclictest)}}) {
      for (const auto& [upper_us, count] : distribution.buckets()) {
        text += fmt::format("{},{},{:.3f},{}\n", one.condition, program, upper_us, count);
      }
    }
  }
  app::writeFile(path, text);
}

}  // namespace patella::bench
