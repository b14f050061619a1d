#include "tools/studies/learning/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace patella::study {
namespace {

/// Results of one estimator in one condition, over seeds.
struct Row {
  const LegResult* first = nullptr;
  std::array<std::vector<double>, 2> error;
  std::array<std::vector<double>, 2> delay_ms;
  std::vector<double> ratio;
};

bool sameCase(const LegResult& a, const LegResult& b) {
  return a.condition == b.condition && a.horizon_s == b.horizon_s;
}

double sumOf(const LegResult& result) {
  return result.error_Nm[0] + result.error_Nm[1];
}

std::vector<Row> rowsOf(std::span<const LegResult> results) {
  std::vector<Row> rows;
  const LegResult* reference = nullptr;  // the observer comes first
  for (const LegResult& result : results) {
    if (reference == nullptr || !sameCase(*reference, result) || reference->seed != result.seed) {
      reference = &result;
    }
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
      return sameCase(*r.first, result) && r.first->estimator == result.estimator;
    });
    if (row == rows.end()) {
      row = rows.insert(rows.end(), Row{.first = &result, .error = {}, .delay_ms = {}, .ratio = {}});
    }
    for (std::size_t joint = 0; joint < 2; ++joint) {
      row->error[joint].push_back(result.error_Nm[joint]);
      row->delay_ms[joint].push_back(1e3 * result.delay_s[joint]);
    }
    row->ratio.push_back(sumOf(result) / sumOf(*reference));
  }
  return rows;
}

}  // namespace

double meanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double halfInterval(std::span<const double> values) {
  // Student's t, two-sided 95 %, for 1 to 10 degrees of freedom; beyond, that of 10.
  constexpr std::array kQuantile = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  if (values.size() < 2) {
    return 0.0;
  }
  const double mean = meanOf(values);
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const std::size_t degrees = values.size() - 1;
  const double deviation = std::sqrt(squares / static_cast<double>(degrees));
  return kQuantile[std::min(degrees, kQuantile.size()) - 1] * deviation /
         std::sqrt(static_cast<double>(values.size()));
}

std::string line(const LegResult& r) {
  return fmt::format("{}, seed {}, {:g} ms ahead, {}: {:.4f} / {:.4f} N·m\n", r.condition, r.seed,
                     1e3 * r.horizon_s, r.estimator, r.error_Nm[0], r.error_Nm[1]);
}

std::string table(std::span<const LegResult> results) {
  std::string text =
      "| condition | ahead / ms | estimator | joint 1 / N·m | joint 2 / N·m | ratio to the observer (each "
      "seed) | delay "
      "/ ms |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Row& row : rowsOf(results)) {
    text += fmt::format(
        "| {} | {:g} | {} | {:.4f} ± {:.4f} | {:.4f} ± {:.4f} | {:.2f} ± {:.2f} ({:.2f}) | {:.0f} / {:.0f} "
        "|\n",
        row.first->condition, 1e3 * row.first->horizon_s, row.first->estimator, meanOf(row.error[0]),
        halfInterval(row.error[0]), meanOf(row.error[1]), halfInterval(row.error[1]), meanOf(row.ratio),
        halfInterval(row.ratio), fmt::join(row.ratio, ", "), meanOf(row.delay_ms[0]),
        meanOf(row.delay_ms[1]));
  }
  return text;
}

}  // namespace patella::study
