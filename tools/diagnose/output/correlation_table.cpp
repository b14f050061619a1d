#include "tools/diagnose/output/correlation_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "tools/report/html.hpp"

namespace patella::diagnose {
namespace {

using report::escaped;

/// White at 0, blue towards 1, red towards −1.
std::string colourOf(double correlation) {
  const std::array<double, 3> end =
      correlation > 0.0 ? std::array{86.0, 160.0, 214.0} : std::array{226.0, 125.0, 70.0};
  constexpr double kWhite = 255.0;
  const double share = std::abs(correlation);
  const auto mixed = [&](double channel) {
    return static_cast<int>(std::lround(kWhite + share * (channel - kWhite)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mixed(end[0]), mixed(end[1]), mixed(end[2]));
}

std::string cell(double correlation, bool diagonal) {
  if (diagonal) {
    return "<td></td>";
  }
  if (!std::isfinite(correlation)) {
    return "<td>–</td>";
  }
  // Not "-0.00".
  const std::string text = fmt::format("{:.2f}", std::round(100.0 * correlation) / 100.0 + 0.0);
  return fmt::format("<td style=\"background:{}\">{}</td>", colourOf(correlation),
                     std::abs(correlation) > kStrongCorrelation ? "<b>" + text + "</b>" : text);
}

}  // namespace

std::vector<std::string> strongCorrelations(const Correlations& correlations, const Units& units) {
  struct Pair {
    double correlation;
    std::size_t one, other;
  };
  std::vector<Pair> strong;
  for (std::size_t i = 0; i < correlations.parameters.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::abs(correlations.matrix[i][j]) > kStrongCorrelation) {
        strong.push_back({correlations.matrix[i][j], j, i});
      }
    }
  }
  const auto rank = [](const Pair& pair) {
    return std::tuple(-std::abs(pair.correlation), pair.other, pair.one);
  };
  std::sort(strong.begin(), strong.end(), [&](const Pair& a, const Pair& b) { return rank(a) < rank(b); });
  std::vector<std::string> sentences;
  for (const Pair& pair : strong) {
    sentences.push_back(
        fmt::format("{} and {}: {:.3f}, {}", parameterWords(correlations.parameters[pair.one], units),
                    parameterWords(correlations.parameters[pair.other], units), pair.correlation,
                    pair.correlation > 0.0 ? "if one is too large, so is the other"
                                           : "if one is too large, the other is too small"));
  }
  return sentences;
}

std::string correlationTable(const Correlations& correlations, const Units& units) {
  const std::size_t count = correlations.parameters.size();
  if (count < 2) {
    return {};
  }
  std::string text = "<h2>Correlation of the fitted parameters</h2>\n<div class=\"group\">\n";
  const std::vector<std::string> sentences = strongCorrelations(correlations, units);
  text +=
      sentences.empty()
          ? fmt::format(
                "<p>No two parameters are correlated by more than {}: the recording tells them apart.</p>\n",
                kStrongCorrelation)
          : fmt::format("<p>Hard to tell apart (correlation above {}):</p>\n<ul>\n", kStrongCorrelation);
  for (const std::string& sentence : sentences) {
    text += "<li>" + escaped(sentence) + "</li>\n";
  }
  text += sentences.empty() ? "" : "</ul>\n";
  text += "<table class=\"grid heat\">\n<tr><th></th>";
  for (std::size_t j = 0; j < count; ++j) {
    text += fmt::format("<th>{}</th>", j + 1);
  }
  text += "</tr>\n";
  for (std::size_t i = 0; i < count; ++i) {
    text +=
        fmt::format("<tr><td>{}. {}</td>", i + 1, escaped(parameterWords(correlations.parameters[i], units)));
    for (std::size_t j = 0; j < count; ++j) {
      text += cell(correlations.matrix[i][j], i == j);
    }
    text += "</tr>\n";
  }
  return text + "</table>\n</div>\n";
}

}  // namespace patella::diagnose
