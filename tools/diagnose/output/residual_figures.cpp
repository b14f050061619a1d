#include "tools/diagnose/output/residual_figures.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "tools/diagnose/output/residual_analysis.hpp"
#include "tools/diagnose/output/residual_variables.hpp"
#include "tools/diagnose/output/time_figures.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/report/palette.hpp"
#include "tools/report/reduction.hpp"

namespace patella::diagnose {
namespace {

using report::Figure;
using report::Series;

constexpr const char* kBefore = colour::kBefore;
constexpr const char* kAfter = colour::kAfter;
constexpr const char* kBeforePale = report::colour::kPaleRed;
constexpr const char* kAfterPale = report::colour::kPaleBlue;

constexpr std::size_t kScatterPoints = 800;
constexpr std::size_t kBins = 25;
constexpr double kLongestLag_s = 2.0;

const JointCurves& curvesOf(const Diagnosis& diagnosis, int joint) {
  return diagnosis.curves[static_cast<std::size_t>(joint)];
}

std::string jointWords(int joint) {
  return "joint " + std::to_string(joint + 1);
}

std::string residualLabel(const Diagnosis& diagnosis, int joint) {
  return "(drive − model) / " + unitsOf(diagnosis, joint).torque;
}

Series points(const std::vector<double>& x, const std::vector<double>& y, const char* colour) {
  Series series;
  series.points = true;
  series.colour = colour;
  series.width = 0.18;
  const std::size_t step = std::max<std::size_t>(1, x.size() / kScatterPoints);
  for (std::size_t i = 0; i < x.size(); i += step) {
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  }
  return series;
}

Series means(const BinnedMeans& bins, const char* label, const char* colour) {
  Series series;
  series.label = label;
  series.colour = colour;
  series.width = 2.0;
  series.x = bins.x;
  series.y = bins.mean;
  series.error = bins.half_width95;
  return series;
}

/// Outliers must not squeeze the rest.
void limitToBulk(Figure& figure, const std::vector<double>& x) {
  const double low = report::percentile(x, 0.002);
  const double high = report::percentile(x, 0.998);
  const double air = 0.03 * (high - low);
  figure.x_range = {low - air, high + air};
  for (Series& series : figure.series) {
    for (std::size_t i = 0; i < series.x.size() && series.points; ++i) {
      if (series.x[i] < low - air || series.x[i] > high + air) {
        series.y[i] = std::nan("");
      }
    }
  }
}

/// A joint's residual against a variable, after another residual where there is one. Nothing where the
/// recording does not have the variable, or where it never changes.
std::optional<Figure> againstFigure(const Diagnosis& diagnosis, int joint, const Variable& variable,
                                    const Layout& layout, const std::vector<double>* first,
                                    const std::array<const char*, 2>& labels) {
  const std::vector<double>& after = curvesOf(diagnosis, joint).residual_after_Nm;
  const NamedValues x = valuesOf(diagnosis, variable, layout);
  if (x.values.size() != after.size() || std::none_of(x.values.begin(), x.values.end(), [&](double value) {
        return value != x.values.front();
      })) {
    return std::nullopt;
  }
  // Postures have no order in time: each counts for itself, in stretches of one row.
  const auto lags = static_cast<std::size_t>(kLongestLag_s * diagnosis.curves_rate_Hz);
  const double dependent = rowsPerIndependent(autocorrelationOf(after, layout.stretches, lags));
  Figure figure;
  figure.title = "Residual of " + jointWords(joint);
  figure.x_label = x.label;
  figure.y_label = residualLabel(diagnosis, joint);
  if (first != nullptr) {
    figure.series.push_back(points(x.values, *first, kBeforePale));
  }
  figure.series.push_back(points(x.values, after, kAfterPale));
  if (first != nullptr) {
    figure.series.push_back(means(binnedMeans(x.values, *first, kBins, dependent), labels[0], kBefore));
  }
  figure.series.push_back(means(binnedMeans(x.values, after, kBins, dependent), labels[1], kAfter));
  limitToBulk(figure, x.values);
  return figure;
}

/// The residual without one effect, and with it; the others are in the model both times.
std::optional<Figure> effectFigure(const Diagnosis& diagnosis, const EffectFinding& effect,
                                   const Layout& layout) {
  std::vector<double> without = shareOf(diagnosis, effect, layout);
  if (without.empty()) {
    return std::nullopt;
  }
  const std::vector<double>& after = curvesOf(diagnosis, effect.joint).residual_after_Nm;
  std::transform(without.begin(), without.end(), after.begin(), without.begin(), std::plus<>());
  auto figure = againstFigure(diagnosis, effect.joint, betrayedBy(diagnosis, effect), layout, &without,
                              {"without it", "with it"});
  if (figure) {
    figure->section = "Effects found: residual without each and with it; mean in bins with its 95 % interval";
    figure->title = effectWords(effect);
    figure->title.front() =
        static_cast<char>(std::toupper(static_cast<unsigned char>(figure->title.front())));
  }
  return figure;
}

/// A joint's residual against the variable it depends on; it alone, as it may be small beside what was
/// explained.
std::optional<Figure> restFigure(const Diagnosis& diagnosis, const Dependence& dependence,
                                 const Layout& layout) {
  const std::optional<Variable> variable = variableNamed(dependence.variable);
  if (!variable) {
    return std::nullopt;
  }
  auto figure = againstFigure(diagnosis, dependence.joint, *variable, layout, nullptr, {"", "what is left"});
  if (figure) {
    figure->section = "What is left depends on; mean in bins with its 95 % interval";
    figure->title +=
        fmt::format(", {}: explains {} {} rms", dependence.variable, shortNumber(dependence.explained_Nm),
                    unitsOf(diagnosis, dependence.joint).torque);
  }
  return figure;
}

/// A joint without effects against its own motion.
std::optional<Figure> motionFigure(const Diagnosis& diagnosis, int joint, const Layout& layout,
                                   bool at_rest) {
  const bool drawn = std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                                 [&](const EffectFinding& effect) { return effect.joint == joint; });
  if (drawn) {
    return std::nullopt;
  }
  const Variable variable{.kind = at_rest ? Variable::Kind::kPosition : Variable::Kind::kVelocity,
                          .index = joint};
  auto figure = againstFigure(diagnosis, joint, variable, layout,
                              &curvesOf(diagnosis, joint).residual_before_Nm, {"before", "after"});
  if (figure) {
    figure->section = "Joints without an effect: residual before and after";
  }
  return figure;
}

Series curve(std::vector<double> x, std::vector<double> y, const char* label, const char* colour) {
  Series series;
  series.label = label;
  series.colour = colour;
  series.width = 1.6;
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

std::optional<Figure> spectrumFigure(const Diagnosis& diagnosis, int joint, const Layout& layout) {
  const JointCurves& curves = curvesOf(diagnosis, joint);
  Spectrum before = spectrumOf(curves.residual_before_Nm, layout.stretches, diagnosis.curves_rate_Hz);
  Spectrum after = spectrumOf(curves.residual_after_Nm, layout.stretches, diagnosis.curves_rate_Hz);
  if (before.frequency_Hz.empty()) {
    return std::nullopt;
  }
  Figure figure;
  figure.section = "Spectrum and autocorrelation";
  figure.title = "Amplitude density of the residual of " + jointWords(joint);
  figure.x_label = "frequency / Hz";
  figure.y_label = unitsOf(diagnosis, joint).torque + " / √Hz";
  figure.log_x = true;
  figure.log_y = true;
  figure.x_range = {before.frequency_Hz.front(), before.frequency_Hz.back()};
  figure.series.push_back(curve(before.frequency_Hz, std::move(before.density), "before", kBefore));
  figure.series.push_back(curve(after.frequency_Hz, std::move(after.density), "after", kAfter));
  return figure;
}

std::optional<Figure> autocorrelationFigure(const Diagnosis& diagnosis, int joint, const Layout& layout) {
  const JointCurves& curves = curvesOf(diagnosis, joint);
  const auto lags = static_cast<std::size_t>(kLongestLag_s * diagnosis.curves_rate_Hz);
  Figure figure;
  figure.section = "Spectrum and autocorrelation";
  figure.title = "Autocorrelation of the residual of " + jointWords(joint);
  figure.x_label = "lag / s";
  figure.y_label = "correlation";
  const auto add = [&](const std::vector<double>& residual, const char* label, const char* colour) {
    std::vector<double> values = autocorrelationOf(residual, layout.stretches, lags);
    std::vector<double> lag_s(values.size());
    for (std::size_t i = 0; i < lag_s.size(); ++i) {
      lag_s[i] = static_cast<double>(i) / diagnosis.curves_rate_Hz;
    }
    if (!values.empty()) {
      figure.series.push_back(curve(std::move(lag_s), std::move(values), label, colour));
    }
  };
  add(curves.residual_before_Nm, "before", kBefore);
  add(curves.residual_after_Nm, "after", kAfter);
  if (figure.series.empty()) {
    return std::nullopt;
  }
  const double band = 1.96 / std::sqrt(static_cast<double>(curves.time_s.size()));
  figure.levels = {{.value = band, .label = "95 % of white noise"}, {.value = -band, .label = {}}};
  figure.x_range = {0.0, kLongestLag_s};
  return figure;
}

}  // namespace

std::vector<Figure> residualFigures(const Diagnosis& diagnosis) {
  std::vector<Figure> figures;
  if (diagnosis.curves.empty() || diagnosis.curves.front().time_s.empty()) {
    return figures;
  }
  const auto joints = static_cast<int>(diagnosis.curves.size());
  const Layout layout = layoutOf(diagnosis.curves.front(), diagnosis.curves_rate_Hz);
  const bool at_rest = isAtRest(diagnosis);
  const auto add = [&](std::optional<Figure> figure) {
    if (figure) {
      figures.push_back(std::move(*figure));
    }
  };
  for (const EffectFinding& effect : diagnosis.effects) {
    add(effectFigure(diagnosis, effect, layout));
  }
  for (int joint = 0; joint < joints; ++joint) {
    add(motionFigure(diagnosis, joint, layout, at_rest));
  }
  for (const Dependence& dependence : diagnosis.unexplained) {
    add(restFigure(diagnosis, dependence, layout));
  }
  for (int joint = 0; joint < joints && !at_rest; ++joint) {
    add(spectrumFigure(diagnosis, joint, layout));
    add(autocorrelationFigure(diagnosis, joint, layout));
  }
  return figures;
}

}  // namespace patella::diagnose
