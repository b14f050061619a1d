#include "tools/bench/tick/table.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace patella::bench {
namespace {

constexpr std::size_t kShown = static_cast<std::size_t>(tick::Stage::kOutside);

double typical(const StageMeter& meter, tick::Stage stage, Unit unit) {
  return unit == Unit::kNanoseconds ? meter.median(stage) : meter.mean(stage);
}

double typicalOfTick(const StageMeter& meter, Unit unit) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kShown; ++i) {
    sum += typical(meter, static_cast<tick::Stage>(i), unit);
  }
  return sum;
}

/// Nanoseconds are shown as µs.
double shown(double value, Unit unit) {
  return unit == Unit::kNanoseconds ? 1e-3 * value : value;
}

std::string number(double value, Unit unit, int width) {
  return unit == Unit::kNanoseconds ? fmt::format("{:>{}.2f}", shown(value, unit), width)
                                    : fmt::format("{:>{}.0f}", value, width);
}

std::string row(std::string_view name, double mean, double share, const app::LatencyHistogram& histogram,
                Unit unit) {
  std::string text = fmt::format("  {:<12}{}{:>8.1f} %", name, number(mean, unit, 10), 100.0 * share);
  for (const double quantile : {0.5, 0.99, 0.999, 1.0}) {
    text += number(static_cast<double>(histogram.quantile(quantile)), unit, 10);
  }
  return text + "\n";
}

}  // namespace

std::string stageTable(const Workload& workload, const StageMeter& meter, Unit unit) {
  std::string text =
      fmt::format("{}, {} ticks; {} a stage\n  {:<12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", workload.name,
                  meter.ticks(), unit == Unit::kNanoseconds ? "µs" : "instructions", "stage", "mean", "share",
                  "p50", "p99", "p99.9", "max");
  const double whole = typicalOfTick(meter, unit);
  for (std::size_t i = 0; i < kShown; ++i) {
    const auto stage = static_cast<tick::Stage>(i);
    text += row(tick::kStageNames[i], meter.mean(stage), typical(meter, stage, unit) / whole, meter.of(stage),
                unit);
  }
  return text + row("whole tick", meter.meanOfTick(), 1.0, meter.ofTick(), unit);
}

std::string growthHeading(Unit unit) {
  std::string text = fmt::format("\n{} a tick\n{:<24}",
                                 unit == Unit::kNanoseconds ? "median, µs" : "mean, instructions", "");
  for (std::size_t i = 0; i < kShown; ++i) {
    text += fmt::format("{:>10}", tick::kStageNames[i]);
  }
  return text + fmt::format("{:>10}\n", "tick");
}

std::string growthRow(const Workload& workload, const StageMeter& meter, Unit unit) {
  std::string text = fmt::format("{:<24}", workload.name);
  for (std::size_t i = 0; i < kShown; ++i) {
    text += number(typical(meter, static_cast<tick::Stage>(i), unit), unit, 10);
  }
  return text + number(typicalOfTick(meter, unit), unit, 10) + "\n";
}

std::string rateTable(const std::vector<RateResult>& results) {
  std::string text = fmt::format("{:>8}{:>20}{:>10}{:>10}{:>16}{:>22}{:>12}\n", "rate, Hz", "without overrun",
                                 "ticks", "overruns", "missed periods", "p99.9, µs, median", "of period");
  for (const RateResult& result : results) {
    std::vector<double> p999 = result.tick_p999_ns;
    const auto middle = p999.begin() + static_cast<std::ptrdiff_t>(p999.size() / 2);
    std::nth_element(p999.begin(), middle, p999.end());
    text += fmt::format("{:>8.0f}{:>20}{:>10}{:>10}{:>16}{:>21.1f}{:>10.1f} %\n", result.rate_Hz,
                        fmt::format("{} of {} runs", result.runs_without_overrun, result.runs), result.ticks,
                        result.overruns, result.missed_periods, 1e-3 * *middle,
                        100.0 * *middle * 1e-9 * result.rate_Hz);
  }
  return text;
}

}  // namespace patella::bench
