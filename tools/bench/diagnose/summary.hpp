// Summary of many cases: tables for the console and pictures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/diagnose/score.hpp"

namespace patella::bench {

/// One case with its diagnosis and its marks.
struct CaseResult {
  std::uint64_t seed = 0;
  Suite suite = Suite::kNone;
  std::string mechanism, motion;
  double duration_s = 0.0;
  std::size_t joints = 1;
  std::vector<CaseEffect> effects;
  Truth truth;
  diagnose::Diagnosis diagnosis;  ///< without its curves
  Score score;
  std::string error;  ///< what diagnosis threw; everything after `truth` is then void
  double simulating_s = 0.0;
  double diagnosing_s = 0.0;
  double processor_s = 0.0;  ///< of the diagnosis
};

struct Proportion {
  std::size_t hits = 0;
  std::size_t cases = 0;
  double share() const noexcept;
  /// Wilson 1927, Journal of the American Statistical Association 22: 95 %.
  double low() const noexcept;
  double high() const noexcept;
};

/// Strengths within which the power is given: bounds of the bins.
std::vector<double> strengthBins();
/// How often single effects of a strength were named right, a bin each. Effects in the span of the nominal
/// parameters do not count.
std::vector<Proportion> powerCurve(std::span<const CaseResult> results);

/// Rows: the kinds that were true. Columns: what they were called.
struct Confusion {
  std::vector<std::string> rows, columns;
  std::vector<std::vector<std::size_t>> count;
};
Confusion confusionOf(std::span<const CaseResult> results);

std::string summaryText(std::span<const CaseResult> results);

std::string csvHeader();
std::string csvRow(const CaseResult& result);

/// power.png and confusion.png, where there are cases to draw.
void drawSummary(std::span<const CaseResult> results, const std::filesystem::path& folder);

}  // namespace patella::bench
