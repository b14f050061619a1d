#include "tools/diagnose/output/time_figures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <string>

#include <fmt/format.h>

#include "tools/diagnose/output/residual_variables.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/report/palette.hpp"
#include "tools/report/reduction.hpp"

namespace patella::diagnose {
namespace {

using report::Figure;
using report::Series;

constexpr const char* kMeasured = report::colour::kBlack;
using report::colour::kHeldOutShade;
constexpr const char* kGiven = "model as given";
constexpr const char* kFound = "with what was found";

/// Bins of a curve: enough to zoom in several times.
constexpr std::size_t kCurveBins = 1500;

Series lineOf(const char* label, const char* colour) {
  Series series;
  series.label = label;
  series.colour = colour;
  return series;
}

/// Stretches apart, each thinned.
Series overTime(const Layout& layout, const std::vector<double>& values, const char* label,
                const char* colour) {
  Series series = lineOf(label, colour);
  const std::span<const double> x(layout.time_s);
  const std::span<const double> y(values);
  for (const Segment& stretch : layout.stretches) {
    const std::size_t count = stretch.end - stretch.first;
    const std::size_t share = std::max<std::size_t>(2, kCurveBins * count / values.size());
    Series part;
    report::addEnvelope(part, x.subspan(stretch.first, count), y.subspan(stretch.first, count), share);
    series.x.insert(series.x.end(), part.x.begin(), part.x.end());
    series.y.insert(series.y.end(), part.y.begin(), part.y.end());
    series.x.push_back(series.x.back());
    series.y.push_back(std::nan(""));
  }
  return series;
}

double rmsOf(const std::vector<double>& values) {
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Without curves: axes, and what was held out as a shade.
Figure emptyFigure(const JointCurves& curves, const Layout& layout) {
  Figure figure;
  figure.wide = true;
  figure.zoom = true;
  figure.x_range = {layout.time_s.front(), layout.time_s.back()};
  if (layout.time_s != curves.time_s) {
    figure.x_label = "time, one stretch after the other / s";
  }
  for (std::size_t i = 0; i < curves.heldout.size(); ++i) {
    if (!curves.heldout[i]) {
      continue;
    }
    if (i == 0 || !curves.heldout[i - 1]) {
      figure.shades.push_back({.from = layout.time_s[i], .to = layout.time_s[i], .colour = kHeldOutShade});
    }
    figure.shades.back().to = layout.time_s[i];
  }
  return figure;
}

Figure torqueFigure(const Diagnosis& diagnosis, std::size_t joint, const Layout& layout) {
  const JointCurves& curves = diagnosis.curves[joint];
  const auto modelled = [&](const std::vector<double>& residual) {
    std::vector<double> torque(curves.torque_Nm.size());
    std::transform(curves.torque_Nm.begin(), curves.torque_Nm.end(), residual.begin(), torque.begin(),
                   std::minus<>());
    return torque;
  };
  Figure figure = emptyFigure(curves, layout);
  figure.section = "Torque over time: measured, and what the models need for the measured motion";
  figure.title =
      fmt::format("Torque of joint {}{}", joint + 1, figure.shades.empty() ? "" : " (shaded: held out)");
  figure.y_label = "torque / " + unitsOf(diagnosis, static_cast<int>(joint)).torque;
  figure.series.push_back(overTime(layout, curves.torque_Nm, "measured", kMeasured));
  figure.series.push_back(overTime(layout, modelled(curves.residual_before_Nm), kGiven, colour::kBefore));
  figure.series.push_back(overTime(layout, modelled(curves.residual_after_Nm), kFound, colour::kAfter));
  return figure;
}

Figure residualFigure(const Diagnosis& diagnosis, std::size_t joint, const Layout& layout) {
  const JointCurves& curves = diagnosis.curves[joint];
  const std::string unit = unitsOf(diagnosis, static_cast<int>(joint)).torque;
  Figure figure = emptyFigure(curves, layout);
  figure.section = "Residual over time";
  figure.title = fmt::format(
      "Residual of joint {}, rms {} → {} {}{}", joint + 1, shortNumber(rmsOf(curves.residual_before_Nm)),
      shortNumber(rmsOf(curves.residual_after_Nm)), unit, figure.shades.empty() ? "" : " (shaded: held out)");
  figure.y_label = "(drive − model) / " + unit;
  figure.series.push_back(overTime(layout, curves.residual_before_Nm, kGiven, colour::kBefore));
  figure.series.push_back(overTime(layout, curves.residual_after_Nm, kFound, colour::kAfter));
  return figure;
}

/// Times with recordings one after the other, where the next begins anew.
std::vector<double> inOneRow(std::vector<double> time_s) {
  double shift_s = 0.0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] + shift_s < time_s[i - 1]) {
      shift_s = time_s[i - 1] - time_s[i];
    }
    time_s[i] += shift_s;
  }
  return time_s;
}

/// A motion that runs away leaves the picture instead of squeezing the rest.
std::vector<double> withinSight(const SimulatedMotion& motion) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : motion.measured_rad) {
    low = std::isfinite(value) ? std::min(low, value) : low;
    high = std::isfinite(value) ? std::max(high, value) : high;
  }
  const double air = 0.5 * (high - low);
  std::vector<double> values = motion.simulated_rad;
  for (double& value : values) {
    value = value > low - air && value < high + air ? value : std::nan("");
  }
  return values;
}

Figure simulatedFigure(const Diagnosis& diagnosis, std::size_t joint) {
  const SimulatedMotion& before = diagnosis.before.simulated[joint];
  const std::string unit = unitsOf(diagnosis, static_cast<int>(joint)).position;
  Figure figure;
  figure.wide = true;
  figure.zoom = true;
  figure.section = fmt::format(
      "Motion of the held-out part: measured, and simulated from the measured torque over windows of {:.3g} "
      "s",
      diagnosis.simulation_window_s);
  figure.title = fmt::format("Position of joint {}", joint + 1);
  figure.y_label = "position / " + unit;
  const auto add = [&](const SimulatedMotion& motion, std::vector<double> values, const char* label,
                       const char* colour) {
    Series series = lineOf(label, colour);
    series.x = inOneRow(motion.time_s);
    series.y = std::move(values);
    figure.series.push_back(std::move(series));
  };
  add(before, before.measured_rad, "measured", kMeasured);
  add(before, withinSight(before), kGiven, colour::kBefore);
  if (joint < diagnosis.after.simulated.size()) {
    const SimulatedMotion& after = diagnosis.after.simulated[joint];
    add(after, withinSight(after), kFound, colour::kAfter);
    figure.title +=
        fmt::format(", rms error {} → {} {}", shortNumber(diagnosis.before.simulation_rms_rad[joint]),
                    shortNumber(diagnosis.after.simulation_rms_rad[joint]), unit);
  }
  figure.x_range = {figure.series.front().x.front(), figure.series.front().x.back()};
  return figure;
}

}  // namespace

std::vector<Figure> timeFigures(const Diagnosis& diagnosis) {
  std::vector<Figure> figures;
  if (diagnosis.curves.empty() || diagnosis.curves.front().time_s.empty() || isAtRest(diagnosis)) {
    return figures;
  }
  const Layout layout = layoutOf(diagnosis.curves.front(), diagnosis.curves_rate_Hz);
  for (std::size_t joint = 0; joint < diagnosis.curves.size(); ++joint) {
    figures.push_back(torqueFigure(diagnosis, joint, layout));
  }
  for (std::size_t joint = 0; joint < diagnosis.curves.size(); ++joint) {
    figures.push_back(residualFigure(diagnosis, joint, layout));
  }
  for (std::size_t joint = 0; joint < diagnosis.before.simulated.size(); ++joint) {
    if (!diagnosis.before.simulated[joint].time_s.empty()) {
      figures.push_back(simulatedFigure(diagnosis, joint));
    }
  }
  return figures;
}

}  // namespace patella::diagnose
