#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/output/plan_files.hpp"
#include "tools/diagnose/output/power_figures.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/html.hpp"
#include "tools/report/palette.hpp"

namespace patella::diagnose {
namespace {

using report::Figure;

/// Instants of a curve: more than a picture has columns.
constexpr Eigen::Index kMostPoints = 1500;

struct Quantity {
  const char* title;
  std::string unit;
  const Eigen::MatrixXd& values;
  double low, high;
};

// A curve of its own, so that the axis has room for it however far away it is.
report::Series limitAt(double limit, const std::string& unit, double end_s) {
  return {.label = fmt::format("limit {} {}", shortNumber(limit), unit),
          .colour = report::colour::kAlarm,
          .x = {0.0, end_s},
          .y = {limit, limit},
          .width = 1.0,
          .dashed = true};
}

Figure figureOf(const Quantity& quantity, int joint, double step_s) {
  Figure figure;
  figure.section = fmt::format("Joint {}", joint + 1);
  figure.title = fmt::format("Joint {}: {}", joint + 1, quantity.title);
  figure.y_label = quantity.unit;
  figure.zoom = true;
  report::Series series{.label = "reference", .colour = report::colour::kBlue, .x = {}, .y = {}};
  const Eigen::Index every = std::max<Eigen::Index>(1, quantity.values.rows() / kMostPoints);
  for (Eigen::Index i = 0; i < quantity.values.rows(); i += every) {
    series.x.push_back(static_cast<double>(i) * step_s);
    series.y.push_back(quantity.values(i, joint));
  }
  const double end_s = series.x.back();
  figure.x_range = {0.0, end_s};
  figure.series.push_back(std::move(series));
  for (const double limit : {quantity.low, quantity.high}) {
    figure.series.push_back(limitAt(limit, quantity.unit, end_s));
  }
  return figure;
}

Eigen::MatrixXd torqueOf(const MotionPlan& plan, const PlanRequest& request) {
  const SampledMotion& motion = plan.motion.sampled;
  TorqueAlong along(request.model);
  Eigen::MatrixXd torque_Nm(motion.q.rows(), motion.q.cols());
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    torque_Nm.row(i) = along
                           .at(motion.q.row(i).transpose(), motion.dq.row(i).transpose(),
                               motion.ddq.row(i).transpose(), static_cast<double>(i) * motion.step_s, i == 0)
                           .transpose();
  }
  return torque_Nm;
}

std::string summary(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin) {
  const PlanWords words = planWords(plan, request);
  report::Table table{.title = {}, .header = {"what", "value"}, .rows = {}, .words = true};
  table.rows = {
      {"takes", words.use + " that a plan may take"},
      {"a plan may take",
       fmt::format("{:.0f} % of the torque and {:.0f} % of the speed of the limits {}, and the range "
                   "less its margins",
                   kPercent * kTorqueShare, kPercent * kSpeedShare, origin.limits)},
      {"against noise of", words.noise}};
  return "<p>" + report::escaped(words.motion) + "</p>\n" + report::tableText(table) +
         "<p>Run it:</p>\n<pre>" + report::escaped(origin.run_command) + "</pre>\n";
}

}  // namespace

std::string planPage(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin) {
  const SampledMotion& motion = plan.motion.sampled;
  const Eigen::MatrixXd torque_Nm = torqueOf(plan, request);
  std::vector<Figure> figures;
  for (int j = 0; j < request.model.joints(); ++j) {
    const safety::JointLimits& limit = request.limits.joint[static_cast<std::size_t>(j)];
    const Units units = unitsOf(request.model.mechanism, j);
    const std::vector<Quantity> quantities{
        {"position", units.position, motion.q, limit.q_min_rad, limit.q_max_rad},
        {"speed", units.position + "/s", motion.dq, -limit.velocity_rad_s, limit.velocity_rad_s},
        {"torque that the model needs", units.torque, torque_Nm, -limit.torque_Nm, limit.torque_Nm}};
    for (const Quantity& quantity : quantities) {
      figures.push_back(figureOf(quantity, j, motion.step_s));
    }
  }
  // The picture that a diagnosis has of what its recording would have revealed.
  Diagnosis powers;
  powers.extended = request.model;
  powers.rests.resize(static_cast<std::size_t>(request.model.joints()));
  powers.revealed = plan.revealed;
  powers.revealed.insert(powers.revealed.end(), plan.others.begin(), plan.others.end());
  for (Figure& figure : powerFigures(powers)) {
    figure.section = "What a recording of this motion would reveal";
    figures.push_back(std::move(figure));
  }
  const std::vector<std::string> pictures = report::drawSvg(figures);
  return report::pageAround("Planned motion", "<h1>Planned motion</h1>\n" + summary(plan, request, origin) +
                                                  report::figureSections(figures, pictures));
}

}  // namespace patella::diagnose
