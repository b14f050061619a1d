#include "tools/diagnose/verdict/shared_cause.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

auto jointOf(const Dataset& data, const Column& column, int joint) {
  return column.segment(joint * data.rows(), data.rows());
}

// Share of the squares of `before` that `after` has no more, each joint counted in its torque.
double goneFrom(const Dataset& data, const Column& before, const Column& after) {
  const Column torque = data.driveTorque();
  double square_before = 0.0, square_after = 0.0;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const double unit = std::max(1e-12, jointOf(data, torque, joint).squaredNorm());
    square_before += jointOf(data, before, joint).squaredNorm() / unit;
    square_after += jointOf(data, after, joint).squaredNorm() / unit;
  }
  return square_before > 0.0 ? 1.0 - square_after / square_before : 0.0;
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
    if (jointOf(data, left, joint).squaredNorm() >
        (1.0 - unknown::kGoesWith) * jointOf(data, residual, joint).squaredNorm()) {
      return {};
    }
  }
  return fmt::format(
      "{} {:.3g} times what the model as given asks for: a torque constant, a gear's ratio, a unit or the "
      "masses may be wrong.",
      data.joints() == 1 ? "The torque is" : "All torques are", factor);
}

std::vector<model::SerialChainParameters*> chainsOf(model::ModelDescription& model) {
  if (auto* chain = std::get_if<model::SerialChainParameters>(&model.mechanism)) {
    return {chain};
  }
  std::vector<model::SerialChainParameters*> chains;
  if (auto* group = std::get_if<model::ChainGroupParameters>(&model.mechanism)) {
    for (model::SerialChainParameters& chain : group->chains) {
      chains.push_back(&chain);
    }
  }
  return chains;
}

Column torqueUnder(const Dataset& data, model::ModelDescription model, const Eigen::Vector3d& gravity_m_s2) {
  for (model::SerialChainParameters* chain : chainsOf(model)) {
    chain->gravity_m_s2 = gravity_m_s2;
  }
  model.effects.clear();
  model::DynamicsModel dynamics = model::makeModel(model);
  return data.mechanismTorque(dynamics.mechanism(), JointVector::Zero(data.joints()));
}

struct Explained {
  Eigen::VectorXd sizes;  ///< of the columns
  double share = 0.0;     ///< of what is missing on all joints
};

// By columns, beside what is known of the model's parameters.
Explained explainedBy(const Dataset& data, const ModelFit& fit, const Eigen::MatrixXd& columns) {
  const FreeColumns free = freeColumns(fit, fit.prior_weight, columns);
  Eigen::VectorXd wanted(free.weighted.rows());
  wanted << fit.weighting->apply(fit.residual), fit.prior_residual;
  const Eigen::VectorXd sizes =
      free.weighted.completeOrthogonalDecomposition().solve(wanted).cwiseQuotient(free.length);
  const Eigen::VectorXd own = sizes.tail(columns.cols());
  const Column left = fit.residual - fit.tangent * sizes.head(fit.tangent.cols()) - columns * own;
  return {.sizes = own, .share = goneFrom(data, fit.residual, left)};
}

std::string tiltedBase(const Dataset& data, const model::ModelDescription& given, const ModelFit& fit) {
  model::ModelDescription bare = given;
  const std::vector<model::SerialChainParameters*> chains = chainsOf(bare);
  if (chains.empty() || data.joints() == 1) {
    return {};
  }
  const Eigen::Vector3d gravity_m_s2 = chains.front()->gravity_m_s2;
  if (gravity_m_s2.isZero(0.0)) {
    return {};
  }
  const Eigen::Vector3d down = gravity_m_s2.normalized();
  const Eigen::Vector3d first = down.unitOrthogonal();
  const Column weightless = torqueUnder(data, bare, Eigen::Vector3d::Zero());
  // Torque is a straight function of gravity's vector.
  Eigen::MatrixXd tilts(weightless.size(), 2);
  tilts.col(0) = torqueUnder(data, bare, gravity_m_s2.norm() * first) - weightless;
  tilts.col(1) = torqueUnder(data, bare, gravity_m_s2.norm() * down.cross(first)) - weightless;

  const Explained tilt = explainedBy(data, fit, tilts);
  if (tilt.share < unknown::kGoesWith) {
    return {};
  }
  return fmt::format(
      "A base that stands {:.1f}° off the upright that the model has explains {:.0f} % of what is missing on "
      "all "
      "joints: check gravity_m_s2 and how the base is mounted.",
      std::atan(tilt.sizes.norm()) * 180.0 / std::numbers::pi, kPercent * tilt.share);
}

// Columns of torque that are late by a fixed time, as through one filter: less than what is refused.
std::string lateTorque(const Dataset& data, const ModelFit& fit) {
  const Column slope = data.column([](const Series& series, std::size_t i) -> JointVector {
    const auto& torque_Nm = series.measured_torque_Nm;
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, torque_Nm.size() - 1);
    return series.rate_Hz / static_cast<double>(after - before) * (torque_Nm[after] - torque_Nm[before]);
  });
  const Explained late = explainedBy(data, fit, -slope);
  if (late.share < unknown::kGoesWith || late.sizes[0] <= 0.0) {
    return {};
  }
  return fmt::format(
      "Torque columns that come {:.2g} ms late explain {:.0f} % of what is missing on all joints: check "
      "their filters "
      "and times.",
      1e3 * late.sizes[0], kPercent * late.share);
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
            "Of what is missing on joint {0}, {1:.0f} % goes in proportion with {2}{0} and {2}{3}: something "
            "spans "
            "these joints.",
            joint + 1, kPercent * share, stem, other + 1);
      }
    }
  }
  return words;
}

}  // namespace

std::string sharedCause(const Dataset& data, const model::ModelDescription& given, const ModelFit& fit) {
  if (data.isStatic() || fit.residual.isZero(0.0)) {
    return {};
  }
  if (std::string words = scaledTorque(data, given); !words.empty()) {
    return words;
  }
  if (std::string words = tiltedBase(data, given, fit); !words.empty()) {
    return words;
  }
  if (std::string words = lateTorque(data, fit); !words.empty()) {
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
