#include "tools/train/curves.hpp"

#include <cmath>

#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"

namespace patella::train {

void drawCurves(std::span<const Epoch> curve, int kept_epoch, const std::string& title,
                const std::filesystem::path& path) {
  report::Series training{.label = "training", .colour = report::colour::kBlue, .x = {}, .y = {}};
  report::Series validation{.label = "validation", .colour = report::colour::kRed, .x = {}, .y = {}};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto epoch = static_cast<double>(i + 1);
    training.x.push_back(epoch);
    training.y.push_back(curve[i].training);
    if (!std::isnan(curve[i].validation)) {
      validation.x.push_back(epoch);
      validation.y.push_back(curve[i].validation);
    }
  }
  report::Figure figure;
  figure.title = "Loss, in units of the target's scale";
  figure.x_label = "epoch";
  figure.y_label = "loss";
  figure.log_y = true;
  figure.wide = true;
  figure.series.push_back(std::move(training));
  if (!validation.x.empty()) {
    figure.series.push_back(std::move(validation));
  }
  figure.levels.push_back({.value = static_cast<double>(kept_epoch), .label = "kept", .vertical = true});
  report::drawPng(std::span(&figure, 1), title, path);
}

}  // namespace patella::train
