#include "tools/diagnose/verdict/cause_hint.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

auto jointOf(const Dataset& data, const Column& column, int joint) {
  return column.segment(joint * data.rows(), data.rows());
}

std::string scaledTorque(const Dataset& data, const model::ModelDescription& given) {
  const Column torque = data.driveTorque();
  const Column residual = residualOf(data, given).residual;
  const Column asked = torque - residual;
  double product = 0.0, square = 0.0;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const double unit = std::max(1e-12, jointOf(data, torque, joint).squaredNorm());
    product += jointOf(data, asked, joint).dot(jointOf(data, torque, joint)) / unit;
    square += jointOf(data, asked, joint).squaredNorm() / unit;
  }
  const double factor = square > 0.0 ? product / square : 1.0;
  if (!(factor > 0.0) || std::abs(std::log(factor)) < runaway::kTolerance) {
    return {};
  }
  const Column left = torque - factor * asked;
  for (int joint = 0; joint < data.joints(); ++joint) {
    // Of a machine that nobody drives no torque explains all that it leaves, and none of the torque.
    if (jointOf(data, left, joint).squaredNorm() >
        (1.0 - unknown::kGoesWith) * std::min(jointOf(data, residual, joint).squaredNorm(),
                                              jointOf(data, torque, joint).squaredNorm())) {
      return {};
    }
  }
  return fmt::format(
      "{} {:.3g} times what the model as given asks for: a torque constant, a gear's ratio, a unit or the "
      "masses may be wrong.",
      data.joints() == 1 ? "The torque is" : "All torques are", factor);
}

double shareOf(const Eigen::VectorXd& left, const Eigen::MatrixXd& columns) {
  return 1.0 - (left - columns * columns.completeOrthogonalDecomposition().solve(left)).squaredNorm() /
                   left.squaredNorm();
}

std::string spanning(const Dataset& data, const Column& residual, int joint) {
  const Eigen::VectorXd left = jointOf(data, residual, joint);
  double most = unknown::kGoesWith;
  std::string words;
  for (const char* stem : {"q", "dq"}) {
    const bool velocity = stem[0] == 'd';
    const auto columnOf = [&](int of) {
      return data.variable([=](const Series& series, std::size_t i) {
        return velocity ? series.states[i].dq[of] : series.states[i].q[of];
      });
    };
    Eigen::MatrixXd columns(data.rows(), 3);
    columns << Eigen::VectorXd::Ones(data.rows()), columnOf(joint), Eigen::VectorXd::Zero(data.rows());
    const double alone = shareOf(left, columns.leftCols(2));
    for (int other = 0; other < data.joints(); ++other) {
      if (other == joint) {
        continue;
      }
      columns.col(2) = columnOf(other);
      const double share = shareOf(left, columns);
      // What goes with the joint's own motion spans nothing.
      if (share > most && 1.0 - share < (1.0 - unknown::kGoesWith) * (1.0 - alone)) {
        most = share;
        words = fmt::format(
            "{1:.0f} % of what joint {0} lacks goes in proportion with {2}{0} and {2}{3}: something spans "
            "these joints.",
            joint + 1, kPercent * share, stem, other + 1);
      }
    }
  }
  return words;
}

}  // namespace

std::string causeHint(const Dataset& data, const model::ModelDescription& given, const ModelFit& fit) {
  if (data.isStatic() || fit.residual.isZero(0.0)) {
    return {};
  }
  if (std::string words = scaledTorque(data, given); !words.empty()) {
    return words;
  }
  // Only where much is missing: noise goes in proportion with nothing, but a little of anything does.
  const Column torque = data.driveTorque();
  for (int joint = 0; joint < data.joints(); ++joint) {
    if (jointOf(data, fit.residual, joint).norm() >
        unknown::kRestOfNothing * jointOf(data, torque, joint).norm()) {
      if (std::string words = spanning(data, fit.residual, joint); !words.empty()) {
        return words;
      }
    }
  }
  return {};
}

}  // namespace patella::diagnose
