#include "tools/diagnose/fit/torque_timing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/lateness.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

std::vector<Recording> timed(std::span<const Recording> recordings, TorqueTiming timing) {
  std::vector<Recording> changed(recordings.begin(), recordings.end());
  for (Recording& recording : changed) {
    recording.torque_timing = timing;
  }
  return changed;
}

const char* wordsOf(TorqueTiming timing) {
  switch (timing) {
    case TorqueTiming::kHeld:
      return "held";
    case TorqueTiming::kSampled:
      return "what acted at the sample";
    default:
      return "what acted since the sample before";
  }
}

struct Estimates {
  Eigen::VectorXd value;
  Eigen::VectorXd deviation;
};

// Coefficients of the last columns, beside all others.
Estimates lastCoefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                           Eigen::Index count) {
  const Eigen::VectorXd length = columns.colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = columns * length.cwiseInverse().asDiagonal();
  const Eigen::Index before = columns.cols() - count;
  const auto others = scaled.leftCols(before).completeOrthogonalDecomposition();
  const auto without = [&](const Eigen::MatrixXd& some) -> Eigen::MatrixXd {
    return some - scaled.leftCols(before) * others.solve(some);
  };
  const Eigen::MatrixXd own = without(scaled.rightCols(count));
  const Eigen::VectorXd rest = without(target);
  Eigen::MatrixXd gram = own.transpose() * own;
  constexpr double kNextToNothing = 1e-12;
  gram.diagonal().array() += kNextToNothing;
  const Eigen::MatrixXd inverse = gram.inverse();
  const Eigen::VectorXd slope = inverse * (own.transpose() * rest);
  const double variance = (rest - own * slope).squaredNorm() / static_cast<double>(target.size());
  const Eigen::VectorXd unit = length.tail(count);
  return {.value = slope.cwiseQuotient(unit),
          .deviation = (variance * inverse.diagonal()).cwiseSqrt().cwiseQuotient(unit)};
}

// What a held torque is late by, half a period, makes of a torque; as a Column.
Column heldLessSampled(const Dataset& data, std::span<const Recording> recordings, const Column& torque) {
  Column apart = rateOf(data, torque);
  for (const Block& block : data.blocks()) {
    for (int joint = 0; joint < data.joints(); ++joint) {
      apart.segment(joint * data.rows() + block.first, block.end - block.first) *=
          -0.5 / recordings[block.recording].rate_Hz;
    }
  }
  return apart;
}

// What play in a joint's gear leaves where the torque changes sign, of unit size: the motor's acceleration as
// it crosses the gap, and how that changes with the time of the crossing. Joint by joint, as rows.
Eigen::MatrixXd crossings(const Dataset& data, const Column& torque) {
  const Eigen::Index rows = data.rows();
  Column side(torque.size());
  for (Eigen::Index joint = 0; joint < data.joints(); ++joint) {
    const auto own = torque.segment(joint * rows, rows);
    const double turned_Nm =
        std::max(torque_timing::kTurned * std::sqrt(own.squaredNorm() / static_cast<double>(rows)), 1e-300);
    side.segment(joint * rows, rows) = (own / turned_Nm).array().tanh();
  }
  const Column crossing = rateOf(data, rateOf(data, side));
  Eigen::MatrixXd both(torque.size(), 2);
  both << crossing, rateOf(data, crossing);
  return both;
}

// Half periods by which each joint's torque comes early, beside all that could be missing in its simplest
// forms, and beside play. How fast the torque changes is told by these and by the model: the noise of what
// was measured changes faster, and goes with no motion.
Estimates halfPeriods(const Dataset& as_held, std::span<const Recording> recordings,
                      const model::ModelDescription& model, const FitOptions& options) {
  ModelFitter fitter(as_held, model, options);
  const ModelFit fit = fitter.nominal();
  const std::vector<ElementaryColumn> plain = elementaryColumns(as_held);
  const Eigen::Index known = fit.tangent.cols(), joints = as_held.joints(), rows = as_held.rows();
  const auto simple = static_cast<Eigen::Index>(plain.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(fit.tangent.rows(), known + simple + 3 * joints);
  columns.leftCols(known) = fit.tangent;
  for (Eigen::Index i = 0; i < simple; ++i) {
    columns.col(known + i) = plain[static_cast<std::size_t>(i)].torque;
  }
  const Eigen::MatrixXd others = columns.leftCols(known + simple);
  const Eigen::MatrixXd weighted = fit.weighting->apply(others);
  const Eigen::VectorXd length = weighted.colwise().norm().cwiseMax(1e-300);
  const Eigen::VectorXd missing = (weighted * length.cwiseInverse().asDiagonal())
                                      .completeOrthogonalDecomposition()
                                      .solve(fit.weighting->apply(fit.residual))
                                      .cwiseQuotient(length);
  const Column torque = as_held.driveTorque() - fit.residual + others * missing;
  const Column apart = heldLessSampled(as_held, recordings, torque);
  const Eigen::MatrixXd play = crossings(as_held, torque);
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    const auto own = Eigen::seqN(joint * rows, rows);
    columns(own, Eigen::seqN(known + simple + 2 * joint, 2)) = play(own, Eigen::all);
    columns(own, known + simple + 2 * joints + joint) = apart(own);
  }
  return lastCoefficients(fit.weighting->apply(columns), fit.weighting->apply(fit.residual), joints);
}

struct Answer {
  TorqueTiming timing = TorqueTiming::kHeld;
  bool contradictory = false;
};

struct Vote {
  double value = 0.0;      ///< half periods
  double deviation = 0.0;  ///< standard, of it
  double nearest() const { return std::clamp(std::round(value), 0.0, 2.0); }
  /// So many pairs of joints are looked at that chance takes some of them farther apart than one joint's
  /// vote.
  bool contradicts(const Vote& other) const {
    const double far = torque_timing::kContradicts;
    return nearest() != other.nearest() && std::abs(value - other.nearest()) > far * deviation &&
           std::abs(other.value - nearest()) > far * other.deviation;
  }
};

// A joint that is earlier or later than any timing lacks something else, of which this is no test.
Answer answerOf(const Estimates& halves) {
  int telling = 0;
  std::vector<Vote> votes;
  for (Eigen::Index joint = 0; joint < halves.value.size(); ++joint) {
    const Vote vote{.value = halves.value[joint], .deviation = halves.deviation[joint]};
    if (vote.deviation >= torque_timing::kTells) {
      continue;
    }
    ++telling;
    if (std::abs(vote.value - vote.nearest()) <= torque_timing::kNear) {
      votes.push_back(vote);
    }
  }
  double weighted = 0.0, weight = 0.0;
  Answer answer;
  for (const Vote& vote : votes) {
    weighted += vote.value / (vote.deviation * vote.deviation);
    weight += 1.0 / (vote.deviation * vote.deviation);
    answer.contradictory =
        answer.contradictory ||
        std::any_of(votes.begin(), votes.end(), [&](const Vote& other) { return vote.contradicts(other); });
  }
  const bool sure = !votes.empty() && 2 * static_cast<int>(votes.size()) >= telling &&
                    weighted > torque_timing::kSure * std::sqrt(weight);
  // Joints that do not agree lack something else, too, and the answer in the middle is wrong by least.
  if (sure && weighted >= (1.0 + torque_timing::kNear) * weight && !answer.contradictory) {
    answer.timing = TorqueTiming::kBefore;
  } else if (sure && weighted >= torque_timing::kNear * weight) {
    answer.timing = TorqueTiming::kSampled;
  }
  return answer;
}

}  // namespace

std::vector<Recording> withTorqueTiming(std::span<const Recording> recordings,
                                        const model::ModelDescription& model, const FitOptions& options) {
  std::vector<Recording> unchanged(recordings.begin(), recordings.end());
  if (recordings.empty() || recordings.front().is_static ||
      !std::all_of(recordings.begin(), recordings.end(),
                   [](const Recording& recording) { return recording.torque_timing_assumed; })) {
    return unchanged;
  }
  const Estimates halves = halfPeriods(Dataset(recordings, {}), recordings, model, options);
  const Answer answer = answerOf(halves);
  std::vector<Recording> chosen =
      answer.timing == TorqueTiming::kHeld ? std::move(unchanged) : timed(recordings, answer.timing);
  if (answer.contradictory) {
    chosen.front().warnings.push_back(
        fmt::format("some joints follow their torque as if it had been held between samples, others as if it "
                    "had acted earlier: taken as {}, which they say in the mean; --torque decides",
                    wordsOf(answer.timing)));
  } else if (answer.timing != TorqueTiming::kHeld) {
    chosen.front().warnings.push_back(
        fmt::format("the motion follows the torque too early for one that was held between samples: taken as "
                    "{}; --torque decides",
                    wordsOf(answer.timing)));
  }
  return chosen;
}

}  // namespace patella::diagnose
