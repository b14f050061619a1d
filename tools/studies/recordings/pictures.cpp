#include <algorithm>
#include <numbers>
#include <tuple>

#include <spdlog/fmt/fmt.h>

#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"
#include "tools/studies/recordings/tables.hpp"

namespace patella::study {

using namespace offline;
using namespace report::colour;
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::size_t kEveryTenth = 10;

/// Every stride-th sample over its time, in other units.
report::Series curve(const std::string& label, const char* colour, const Samples& signal, double rate_Hz,
                     std::size_t stride, double factor, double start_s = 0.0) {
  report::Series series{.label = label, .colour = colour, .x = {}, .y = {}};
  for (std::size_t k = 0; k < signal.size(); k += stride) {
    series.x.push_back(start_s + static_cast<double>(k) / rate_Hz);
    series.y.push_back(factor * signal[k]);
  }
  return series;
}

report::Figure emgFigure(const EmgStudy& study) {
  report::Figure figure;
  figure.title = fmt::format("{}, {}: correlation with angle {:.2f}, EMG {:.0f} ms ahead", study.person,
                             study.flexion ? "flexors dominate" : "extensors dominate",
                             study.angle.correlation, 1e3 * study.angle.lag_s);
  figure.y_label = "torque / N·m";
  figure.right_label = "knee / °";
  figure.wide = true;
  figure.x_range = {0.0, static_cast<double>(study.knee_rad.size()) / study.rate_Hz};
  figure.series.push_back(curve("torque from EMG", kBlue, study.torque_Nm, study.rate_Hz, kEveryTenth, 1.0));
  figure.series.push_back(
      curve("knee, recorded", kRed, study.knee_rad, study.rate_Hz, kEveryTenth, kDegrees));
  // The leg of the model is straight at 0; goniometers are not zeroed alike.
  figure.series.push_back(
      curve("knee, simulated", kGrey, study.simulated_knee_rad, study.rate_Hz, kEveryTenth, kDegrees));
  figure.series[1].right_axis = figure.series[2].right_axis = true;
  figure.series[2].dashed = true;
  for (const Onset& onset : study.onsets) {
    figure.shades.push_back({.from = std::min(onset.emg_s, onset.motion_s),
                             .to = std::max(onset.emg_s, onset.motion_s),
                             .colour = onset.lead_s() > 0.0 ? kPaleGreen : kFaultShade});
  }
  return figure;
}

report::Figure torqueFigure(const PendulumStudy& study, std::size_t joint) {
  const JointComparison& c = study.joint[joint];
  report::Figure figure;
  figure.title = fmt::format("joint {}: correlation {:.3f}, difference {:.3f} of {:.3f} N·m RMS", joint + 1,
                             c.correlation_aligned, c.rms_difference_aligned_Nm, c.rms_offline_Nm);
  figure.y_label = "d / N·m";
  figure.wide = true;
  figure.x_range = {study.time_s.front(), study.time_s.back()};
  const Samples rest = difference(c.aligned_Nm, c.offline_Nm);
  for (const auto& [label, colour, signal] :
       {std::tuple{"difference", kGrey, &rest}, std::tuple{"offline", kRed, &c.offline_Nm},
        std::tuple{"loop", kBlue, &c.aligned_Nm}}) {
    figure.series.push_back(curve(label, colour, *signal, study.rate_Hz, 1, 1.0, study.time_s.front()));
  }
  return figure;
}

report::Figure rateFigure(const PendulumStudy& study, std::size_t joint) {
  const JointComparison& c = study.joint[joint];
  report::Figure figure;
  figure.title = fmt::format("joint {}: mean friction {:.2f} N·m", joint + 1, c.friction_loop_Nm);
  figure.x_label = "rate / rad/s";
  figure.y_label = "d / N·m";
  for (const auto& [label, colour, signal] :
       {std::tuple{"offline", kRed, &c.offline_Nm}, std::tuple{"loop", kBlue, &c.aligned_Nm}}) {
    report::Series series{.label = label, .colour = colour, .x = c.rate_rad_s, .y = *signal, .width = 0.7};
    figure.series.push_back(std::move(series));
  }
  return figure;
}

}  // namespace

void drawEmg(std::span<const EmgStudy> studies, const std::filesystem::path& picture) {
  std::vector<report::Figure> figures;
  std::transform(studies.begin(), studies.end(), std::back_inserter(figures), emgFigure);
  report::drawPng(figures,
                  "Knee torque that the loop makes of recorded EMG. Shaded between the onsets: green EMG "
                  "first, red motion first",
                  picture);
}

void drawPendulum(const PendulumStudy& study, const std::filesystem::path& picture) {
  const std::vector<report::Figure> figures{torqueFigure(study, 0), torqueFigure(study, 1),
                                            rateFigure(study, 0), rateFigure(study, 1)};
  report::drawPng(
      figures,
      fmt::format(
          "Two-link arm, {}: torque that the rigid body does not explain, the loop's {:.1f} ms earlier",
          study.run, 1e3 * study.delay_s),
      picture);
}

}  // namespace patella::study
