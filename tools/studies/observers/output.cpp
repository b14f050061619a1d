#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/palette.hpp"
#include "tools/studies/observers/study.hpp"

namespace patella::study {
namespace {

using namespace report::colour;

const char* kindName(Method::Kind kind) {
  switch (kind) {
    case Method::Kind::kCausal:
      return "causal";
    case Method::Kind::kDelayed:
      return "delayed";
    case Method::Kind::kOffline:
      break;
  }
  return "offline";
}

int number(sim::PaperExperiment experiment) {
  return experiment == sim::PaperExperiment::kFirst ? 1 : 2;
}

const char* unit(const Condition& condition) {
  return condition.corrected ? "N·m" : "rad/s²";
}

std::string title(const Condition& condition) {
  const char* noise = condition.noise == Noise::kVelocity     ? "noise on velocity"
                      : condition.noise == Noise::kBothStates ? "noise on both states"
                                                              : "encoder only";
  return fmt::format("experiment {}, {}", number(condition.experiment), noise);
}

std::string tunedText(const Result& result) {
  const std::vector<Tunable> tunables = tunablesOf(*result.method, result.condition);
  std::string text;
  for (std::size_t i = 0; i < tunables.size(); ++i) {
    const bool follows = i > 0 && tunables[i].name == tunables[i - 1].name;
    text += follows
                ? fmt::format("/{:.3g}", result.values[i])
                : fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", tunables[i].name, result.values[i]);
  }
  return text;
}

std::string delayText(const Result& result) {
  return fmt::format("{} / {}", std::lround(1e3 * result.delay_s[0].mean),
                     std::lround(1e3 * result.delay_s[1].mean));
}

}  // namespace

std::string tables(const std::vector<Result>& results) {
  std::string text;
  const Condition* before = nullptr;
  for (const Result& r : results) {
    if (before == nullptr || before->experiment != r.condition.experiment ||
        before->noise != r.condition.noise) {
      text += fmt::format(
          "\n{}: mean error in {}, joint 1 / joint 2\n\n| method | | mean | sd over seeds | delay / ms | "
          "tuned |\n"
          "|---|---|---|---|---|---|\n",
          title(r.condition), unit(r.condition));
    }
    before = &r.condition;
    text += fmt::format("| {} | {} | {:.4f} / {:.4f} | {:.4f} / {:.4f} | {} | {} |\n", r.method->name,
                        kindName(r.method->kind), r.error[0].mean, r.error[1].mean, r.error[0].deviation,
                        r.error[1].deviation, delayText(r), tunedText(r));
  }
  return text;
}

void writeCsv(const std::vector<Result>& results, const std::filesystem::path& path) {
  std::string text = "experiment,noise,unit,method,kind,joint,error_mean,error_sd,delay_s,delay_sd_s,tuned\n";
  for (const Result& r : results) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      text += fmt::format("{},{},{},\"{}\",{},{},{:.6g},{:.6g},{:.6g},{:.6g},\"{}\"\n",
                          number(r.condition.experiment), noiseName(r.condition.noise), unit(r.condition),
                          r.method->name, kindName(r.method->kind), joint + 1, r.error[joint].mean,
                          r.error[joint].deviation, r.delay_s[joint].mean, r.delay_s[joint].deviation,
                          tunedText(r));
    }
  }
  app::writeFile(path, text);
}

void draw(const std::vector<Result>& results, const std::filesystem::path& path) {
  std::vector<report::Figure> figures;
  for (const Condition& condition : kConditions) {
    report::Figure figure;
    figure.title = title(condition);
    figure.x_label = fmt::format("mean error / {}", unit(condition));
    double largest = 0.0;
    for (const Result& r : results) {
      if (r.condition.experiment != condition.experiment || r.condition.noise != condition.noise) {
        continue;
      }
      const std::size_t row = figure.rows.size();
      figure.rows.push_back(r.method->name);
      figure.bars.push_back({.row = row,
                             .from = 0.0,
                             .to = r.error[0].mean,
                             .colour = r.method->kind == Method::Kind::kCausal ? kBlue : kGrey});
      figure.row_marks.push_back({.row = row, .at = r.error[1].mean, .colour = kRed});
      largest = std::max({largest, r.error[0].mean, r.error[1].mean});
    }
    if (figure.rows.empty()) {
      continue;
    }
    figure.x_range = {0.0, 1.05 * largest};
    figures.push_back(std::move(figure));
  }
  report::drawPng(
      figures, "Mean error of every observer: joint 1 as bars, joint 2 as marks, delayed and offline in grey",
      path);
}

}  // namespace patella::study
