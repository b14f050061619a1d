#include "tools/diagnose/verdict/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>
#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Differences between recordings, significant and large enough to matter: sentences, and dependences on the
/// variable "recording".
struct Contradictions {
  std::vector<std::string> what;
  std::vector<Dependence> dependences;
};

// The weighted rows of one recording, zeros elsewhere: an autoregression starts anew in each block.
Eigen::MatrixXd weightedPart(const Dataset& data, const ModelFit& fit,
                             const Eigen::Ref<const Eigen::MatrixXd>& columns, std::size_t recording) {
  Eigen::MatrixXd masked = Eigen::MatrixXd::Zero(columns.rows(), columns.cols());
  for (const Block& block : data.blocks()) {
    for (int joint = 0; joint < data.joints() && block.recording == recording; ++joint) {
      const Eigen::Index first = joint * data.rows() + block.first;
      masked.middleRows(first, block.end - block.first) = columns.middleRows(first, block.end - block.first);
    }
  }
  return fit.weighting->apply(masked);
}

std::vector<std::size_t> recordingsOf(const Dataset& data) {
  std::vector<std::size_t> all;
  for (const Block& block : data.blocks()) {
    if (std::find(all.begin(), all.end(), block.recording) == all.end()) {
      all.push_back(block.recording);
    }
  }
  return all;
}

struct Local {
  Eigen::VectorXd step;       // from the common fit
  Eigen::VectorXd deviation;  // standard
};

Local localFit(const Dataset& data, const ModelFit& fit, std::size_t recording) {
  const Eigen::MatrixXd slope = weightedPart(data, fit, fit.tangent, recording);
  const Eigen::VectorXd error = weightedPart(data, fit, fit.residual, recording);
  const Eigen::VectorXd prior = fit.prior_weight.cwiseAbs2();
  Eigen::MatrixXd information = gramOf(slope);
  information.diagonal() += prior;
  // In units of each parameter's own information, with next to none for what the recording does not show.
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  constexpr double kNextToNone = 1e-9;
  scaled.diagonal().array() += kNextToNone;
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols())) *
      scale.asDiagonal();
  const Eigen::VectorXd right = slope.transpose() * error + fit.prior_weight.cwiseProduct(fit.prior_residual);
  return {.step = inverse * right,
          .deviation = fit.prior_scale * inverse.diagonal().cwiseMax(0.0).cwiseSqrt()};
}

// The parameter that says how strong a term is: its largest coefficient, or what its torque is proportional
// to.
std::optional<Eigen::Index> strengthOf(const ModelFit& fit, std::size_t t) {
  const Term& term = fit.terms[t];
  if (term.c.empty()) {
    return term.recipe->proportional ? std::optional(fit.offset[t]) : std::nullopt;
  }
  Eigen::Index best = 0;
  double largest = -1.0;
  for (std::size_t i = 0; i < term.c.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double size = std::abs(term.c[i]) * fit.tangent.col(fit.offset[t] + index).norm();
    if (size > largest) {
      largest = size;
      best = index;
    }
  }
  return fit.offset[t] + best;
}

double valueAt(const Term& term, Eigen::Index index) {
  const auto i = static_cast<std::size_t>(index);
  return i < term.c.size() ? term.c[i] : term.nu[i - term.c.size()];
}

void compareStrengths(const Dataset& data, const ModelFit& fit, std::span<const std::string> names,
                      std::span<const std::size_t> recordings, Contradictions& result) {
  std::vector<Local> locals;
  for (const std::size_t recording : recordings) {
    locals.push_back(localFit(data, fit, recording));
  }
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const std::optional<Eigen::Index> strength = fit.terms[t].declared ? std::nullopt : strengthOf(fit, t);
    for (std::size_t a = 0; strength && a < locals.size(); ++a) {
      const double common = valueAt(fit.terms[t], *strength - fit.offset[t]);
      const auto other = std::find_if(
          locals.begin() + static_cast<std::ptrdiff_t>(a) + 1, locals.end(), [&](const Local& b) {
            const double one = common + locals[a].step[*strength];
            const double two = common + b.step[*strength];
            const double apart = std::abs(one - two);
            return apart > contradiction::kMaterialShare * std::max(std::abs(one), std::abs(two)) &&
                   apart > contradiction::kDeviations999 *
                               (locals[a].deviation[*strength] + b.deviation[*strength]);
          });
      if (other == locals.end()) {
        continue;
      }
      const auto b = static_cast<std::size_t>(other - locals.begin());
      result.what.push_back(fmt::format(
          "{} differs between recordings: {:.0f} % of its strength in {}, {:.0f} % in {}",
          fit.terms[t].recipe->label(), 100.0 * (1.0 + locals[a].step[*strength] / common),
          names[recordings[a]], 100.0 * (1.0 + other->step[*strength] / common), names[recordings[b]]));
      result.dependences.push_back(
          {.joint = fit.terms[t].recipe->joint,
           .variable = "recording",
           .explained_Nm = std::abs(locals[a].step[*strength]) *
                           jointRms(data, fit.tangent.col(*strength), fit.terms[t].recipe->joint)});
      break;
    }
  }
}

struct Squares {
  double rest = 0.0;
  Eigen::Index rank = 0;
};

Squares leastSquares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
    const double length = scaled.col(k).norm();
    scaled.col(k) /= length > 0.0 ? length : 1.0;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-6);
  const Eigen::VectorXd turned = qr.householderQ().transpose() * target;
  return {.rest = turned.tail(turned.size() - qr.rank()).squaredNorm(), .rank = qr.rank()};
}

void compareErrors(const Dataset& data, const ModelFit& fit, std::span<const std::size_t> recordings,
                   Contradictions& result) {
  const std::vector<ElementaryColumn> plain = elementaryColumns(data);
  Eigen::MatrixXd columns(fit.tangent.rows(), fit.tangent.cols() + static_cast<Eigen::Index>(plain.size()));
  columns.leftCols(fit.tangent.cols()) = fit.tangent;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    columns.col(fit.tangent.cols() + static_cast<Eigen::Index>(i)) = plain[i].torque;
  }
  const Squares together = leastSquares(fit.weighting->apply(columns), fit.weighting->apply(fit.residual));
  Squares apart;
  for (const std::size_t recording : recordings) {
    const Squares one = leastSquares(weightedPart(data, fit, columns, recording),
                                     weightedPart(data, fit, fit.residual, recording));
    // The rows of the other recordings are zeros in it.
    apart.rest += one.rest;
    apart.rank += one.rank;
  }
  const Eigen::Index freedom = apart.rank - together.rank;
  if (freedom <= 0 || apart.rest > contradiction::kSameMachine * together.rest) {
    return;
  }
  const double gain = (together.rest - apart.rest) / fit.redundancy();
  const double p_value = boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(static_cast<double>(freedom)), std::max(0.0, gain)));
  if (p_value >= contradiction::kSignificant) {
    return;
  }
  const double share = 1.0 - apart.rest / together.rest;
  result.what.push_back(
      fmt::format("what is left differs between recordings: {:.0f} % less where each is fitted alone",
                  100.0 * (1.0 - std::sqrt(1.0 - share))));
  const bool named = !result.dependences.empty();
  for (int joint = 0; joint < data.joints() && !named; ++joint) {
    result.dependences.push_back({.joint = joint,
                                  .variable = "recording",
                                  .explained_Nm = std::sqrt(share) * jointRms(data, fit.residual, joint),
                                  .p_value = std::max(p_value, 1e-300)});
  }
}

}  // namespace

void judgeConsistency(const Dataset& data, const ModelFit& fit, std::span<const std::string> names,
                      Diagnosis& diagnosis) {
  const std::vector<std::size_t> recordings = recordingsOf(data);
  if (recordings.size() < 2) {
    return;
  }
  Contradictions found;
  compareStrengths(data, fit, names, recordings, found);
  compareErrors(data, fit, recordings, found);
  if (found.what.empty()) {
    return;
  }
  diagnosis.doubts.push_back(
      {Doubt::kRecordingsDisagree, "The recordings contradict each other: " + found.what.front() + "."});
  diagnosis.unexplained.insert(diagnosis.unexplained.begin(), found.dependences.begin(),
                               found.dependences.end());
  diagnosis.warnings.insert(diagnosis.warnings.end(), found.what.begin(), found.what.end());
}

}  // namespace patella::diagnose
