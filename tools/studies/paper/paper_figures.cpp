#include "tools/studies/paper/paper_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"
#include "tools/studies/paper/network_case.hpp"
#include "tools/train/score.hpp"

namespace patella::study {
namespace {

using report::Figure;
using report::Series;
using report::colour::kBlue;

constexpr std::uint64_t kDrawnSeed = 1;
constexpr const char* kTruth = report::colour::kBlack;
constexpr const char* kNetwork = report::colour::kRed;
constexpr const char* kObserver = report::colour::kSky;
constexpr double kZoomFrom_s = 20.0;
constexpr double kZoomTo_s = 24.0;

std::string unitOf(const Condition& condition) {
  return condition.corrected ? "N·m" : "rad/s²";
}

std::string axisOf(const Condition& condition, int joint) {
  return fmt::format("{}{} / {}", condition.corrected ? "d" : "f_u", joint + 1, unitOf(condition));
}

/// A network's estimate of a motion, beside the truth; untested steps are gaps.
struct Drawn {
  std::string title;
  std::vector<double> time_s;
  std::array<std::vector<double>, 2> truth;
  std::array<std::vector<double>, 2> network;
};

Drawn drawnOf(const std::string& title, const Material& material, const network::NetworkWeights& weights) {
  Drawn drawn{.title = title, .time_s = {}, .truth = {}, .network = {}};
  const train::Sequence& sequence = material.sequence;
  const train::Rows delivered = deliveredOf(weights, sequence);
  for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
    const bool tested = sequence.role[static_cast<std::size_t>(step)] == train::Role::kTest;
    drawn.time_s.push_back(static_cast<double>(step) / sequence.rate_Hz);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const auto column = static_cast<Eigen::Index>(joint);
      drawn.truth[joint].push_back(material.truth(step, column));
      drawn.network[joint].push_back(tested ? delivered(step, column)
                                            : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return drawn;
}

Series lineOf(const std::string& label, const char* colour, const std::vector<double>& x,
              const std::vector<double>& y) {
  return {.label = label, .colour = colour, .x = x, .y = y};
}

Figure panelOf(const Drawn& drawn, const Condition& condition, std::size_t joint) {
  Figure figure;
  figure.title = drawn.title;
  figure.y_label = axisOf(condition, static_cast<int>(joint));
  figure.series.push_back(lineOf("truth", kTruth, drawn.time_s, drawn.truth[joint]));
  Series points = lineOf("network", kNetwork, drawn.time_s, drawn.network[joint]);
  points.points = true;
  points.width = 0.2;
  figure.series.push_back(std::move(points));
  return figure;
}

void drawTorques(const PaperOptions& options, const std::filesystem::path& path) {
  const auto torques = sim::paperTorques(kDrawnSeed);
  std::vector<Figure> figures;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    Figure figure;
    figure.title = joint == 0 ? "hip" : "knee";
    figure.y_label = "torque / N·m";
    figure.wide = true;
    Series series = lineOf("", kBlue, {}, {});
    for (double t = 0.0; t <= options.seconds; t += 0.01) {
      series.x.push_back(t);
      series.y.push_back(torques[joint].at(t));
    }
    figure.series.push_back(std::move(series));
    figures.push_back(std::move(figure));
  }
  report::drawPng(figures, "Figure 3: torques from EMG", path);
}

/// Figures 4 and 5, or 7 and 8.
void drawCurves(const NetworkCase& one, int first, const std::filesystem::path& folder) {
  Figure rmse;
  rmse.x_label = "epoch";
  rmse.y_label = "RMSE / " + unitOf(one.condition);
  rmse.log_y = true;
  rmse.wide = true;
  Series series = lineOf("", kBlue, {}, {});
  for (std::size_t epoch = 0; epoch < one.curve.size(); ++epoch) {
    series.x.push_back(static_cast<double>(epoch + 1));
    series.y.push_back(one.output_scale * std::sqrt(one.curve[epoch].training));
  }
  rmse.series.push_back(series);
  Figure loss = rmse;
  loss.y_label = "loss";
  for (std::size_t epoch = 0; epoch < one.curve.size(); ++epoch) {
    loss.series.front().y[epoch] = one.curve[epoch].training;
  }
  const int number = numberOf(one.condition.experiment);
  report::drawPng(
      std::span(&rmse, 1),
      fmt::format("Figure {}: RMSE on the trained steps, experiment {}, random split", first, number),
      folder / fmt::format("figure_{:02}.png", first));
  report::drawPng(std::span(&loss, 1),
                  fmt::format("Figure {}: loss (squares, in units of the target's variance), experiment {}, "
                              "random split",
                              first + 1, number),
                  folder / fmt::format("figure_{:02}.png", first + 1));
}

const NetworkCase* find(const PaperResults& results, const Condition& condition, train::SplitKind split) {
  const auto found =
      std::find_if(results.networks.begin(), results.networks.end(), [&](const NetworkCase& one) {
        return one.condition.experiment == condition.experiment &&
               one.condition.corrected == condition.corrected && one.split == split && one.seed == kDrawnSeed;
      });
  return found == results.networks.end() ? nullptr : &*found;
}

std::vector<Drawn> testsOf(const PaperOptions& options, const PaperResults& results,
                           const Condition& condition) {
  const std::vector<double> values = targetValues(options, condition);
  std::vector<Drawn> tests;
  for (const train::SplitKind split : options.splits) {
    if (const NetworkCase* one = find(results, condition, split)) {
      tests.push_back(drawnOf(train::splitNames()[static_cast<std::size_t>(split)] + " split",
                              materialOfCase(options, condition, split, kDrawnSeed, values), one->weights));
    }
  }
  if (const NetworkCase* random = find(results, condition, train::SplitKind::kRandom)) {
    for (const Unseen unseen : {Unseen::kTrajectory, Unseen::kPush}) {
      tests.push_back(drawnOf(
          nameOf(unseen), materialOfUnseen(options, condition, unseen, kDrawnSeed, values), random->weights));
    }
  }
  return tests;
}

/// Figure 6 or 9, with what the paper does not show below it.
void drawEstimates(const std::vector<Drawn>& tests, const Condition& condition, int number,
                   const std::filesystem::path& folder) {
  std::vector<Figure> figures;
  for (const Drawn& test : tests) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      figures.push_back(panelOf(test, condition, joint));
    }
  }
  report::drawPng(
      figures,
      fmt::format("Figure {}: unknown dynamics, and what the network says at the tested steps, experiment {}",
                  number, numberOf(condition.experiment)),
      folder / fmt::format("figure_{:02}.png", number));
}

/// A copy of a curve within the zoom.
Series zoomed(const Series& series) {
  Series part = series;
  part.x.clear();
  part.y.clear();
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (series.x[i] >= kZoomFrom_s && series.x[i] <= kZoomTo_s) {
      part.x.push_back(series.x[i]);
      part.y.push_back(series.y[i]);
    }
  }
  part.width = std::max(series.width, 0.5);
  return part;
}

void drawBeside(const PaperOptions& options, const Drawn& random, const Result& itsmc,
                const std::filesystem::path& folder) {
  const Trace trace =
      follow(*itsmc.method, itsmc.values, record(itsmc.condition, options.seconds, kDrawnSeed));
  std::vector<Figure> figures;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    Figure figure = panelOf(random, itsmc.condition, joint);
    figure.title = fmt::format("joint {}", joint + 1);
    Series observer = lineOf("ITSMC", kObserver, {}, {});
    for (std::size_t k = 0; k < trace.estimate[joint].size(); k += 10) {
      observer.x.push_back(kSettling_s + static_cast<double>(k) / kRate_Hz);
      observer.y.push_back(trace.estimate[joint][k]);
    }
    figure.series.insert(figure.series.begin(), std::move(observer));
    figures.push_back(std::move(figure));
  }
  for (std::size_t joint = 0; joint < 2 && options.seconds > kZoomTo_s; ++joint) {
    Figure figure = figures[joint];
    figure.title += ", zoom";
    for (Series& series : figure.series) {
      series = zoomed(series);
    }
    figures.push_back(std::move(figure));
  }
  report::drawPng(figures, "Figure 10: the network on the random split, and ITSMC, experiment 2",
                  folder / "figure_10.png");
}

}  // namespace

void drawFigures(const PaperOptions& options, const PaperResults& results,
                 const std::filesystem::path& folder) {
  for (const Condition& condition : options.conditions) {
    const std::filesystem::path pictures = folder / (condition.corrected ? "corrected" : "as_printed");
    std::filesystem::create_directories(pictures);
    drawTorques(options, pictures / "figure_03.png");
    const int first = condition.experiment == sim::PaperExperiment::kFirst ? 4 : 7;
    const NetworkCase* random = find(results, condition, train::SplitKind::kRandom);
    if (random != nullptr) {
      drawCurves(*random, first, pictures);
    }
    const std::vector<Drawn> tests = testsOf(options, results, condition);
    if (!tests.empty()) {
      drawEstimates(tests, condition, first + 2, pictures);
    }
    const auto itsmc =
        std::find_if(results.observers.begin(), results.observers.end(), [&](const Result& result) {
          return result.condition.experiment == condition.experiment &&
                 result.condition.corrected == condition.corrected &&
                 result.method->name.starts_with("ITSMC");
        });
    const bool is_second = condition.experiment == sim::PaperExperiment::kSecond;
    if (is_second && random != nullptr && itsmc != results.observers.end()) {
      const std::vector<double> values = targetValues(options, condition);
      const Material material =
          materialOfCase(options, condition, train::SplitKind::kRandom, kDrawnSeed, values);
      drawBeside(options, drawnOf("", material, random->weights), *itsmc, pictures);
    }
  }
}

}  // namespace patella::study
