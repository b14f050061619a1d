#include "tools/diagnose/verdict/shared_cause.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/fit/base_gravity.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/lateness.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/verdict.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

// Share of the squares of `before` that `after` has no more, each joint counted in its torque.
double goneFrom(const Dataset& data, const Column& before, const Column& after) {
  const Column torque = data.driveTorque();
  double square_before = 0.0, square_after = 0.0;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const double unit = std::max(1e-12, torque.segment(joint * data.rows(), data.rows()).squaredNorm());
    square_before += before.segment(joint * data.rows(), data.rows()).squaredNorm() / unit;
    square_after += after.segment(joint * data.rows(), data.rows()).squaredNorm() / unit;
  }
  return square_before > 0.0 ? 1.0 - square_after / square_before : 0.0;
}

Column torqueUnder(const Dataset& data, const model::ModelDescription& given,
                   const Eigen::Vector3d& gravity_m_s2) {
  model::ModelDescription model = withBaseGravity(given, gravity_m_s2);
  model.effects.clear();
  model::DynamicsModel dynamics = model::makeModel(model);
  return data.mechanismTorque(dynamics.mechanism(), JointVector::Zero(data.joints()));
}

struct Explained {
  Eigen::VectorXd sizes;  ///< of the columns
  Column torque;          ///< of the cause
  double share = 0.0;     ///< of what is missing on all joints
};

// By columns, and by what is `known` of the cause, beside all that the fit estimates.
Explained explainedBy(const Dataset& data, const ModelFit& fit, const Column& known,
                      const Eigen::MatrixXd& columns) {
  const FreeColumns free = freeColumns(fit, fit.prior_weight, columns);
  const Column missing = fit.residual - known;
  Eigen::VectorXd wanted(free.weighted.rows());
  wanted << fit.weighting->apply(missing), fit.prior_residual;
  const Eigen::VectorXd sizes =
      free.weighted.completeOrthogonalDecomposition().solve(wanted).cwiseQuotient(free.length);
  const Eigen::VectorXd own = sizes.tail(columns.cols());
  const Column torque = columns * own;
  const Column left = missing - fit.tangent * sizes.head(fit.tangent.cols()) - torque;
  return {.sizes = own, .torque = known + torque, .share = goneFrom(data, fit.residual, left)};
}

struct Suspicion {
  SharedCause cause;
  double share = 0.0;  ///< of what is missing on all joints
};

std::optional<Suspicion> tiltedBase(const Dataset& data, const model::ModelDescription& given,
                                    const ModelFit& fit, double least_share) {
  const std::optional<Eigen::Vector3d> own_m_s2 = baseGravity(given);
  if (!own_m_s2) {
    return {};
  }
  const Eigen::Vector3d upright = own_m_s2->normalized();
  const double size_m_s2 = own_m_s2->norm();
  const auto torqueAt = [&](const Eigen::Vector3d& down) {
    return torqueUnder(data, given, size_m_s2 * down);
  };
  const Column weightless = torqueAt(Eigen::Vector3d::Zero()), at_upright = torqueAt(upright);
  Eigen::Vector3d down = upright;
  Explained explained;
  // Torque is a straight function of gravity's vector, whose length is kept.
  constexpr int kMostRounds = 3;
  for (int round = 0; round == 0 || (round < kMostRounds && explained.share > least_share); ++round) {
    const Eigen::Vector3d first = down.unitOrthogonal(), second = down.cross(first);
    Eigen::MatrixXd columns(weightless.size(), 2);
    columns << torqueAt(first) - weightless, torqueAt(second) - weightless;
    explained = explainedBy(data, fit, torqueAt(down) - at_upright, columns);
    down = (down + explained.sizes[0] * first + explained.sizes[1] * second).normalized();
  }
  const Eigen::Vector3d gravity_m_s2 = size_m_s2 * down;
  SharedCause cause;
  cause.gravity_m_s2 = gravity_m_s2;
  cause.words = fmt::format(
      "The base stands {:.1f}° off the upright that the model has, at gravity_m_s2 = "
      "[{:.3f}, {:.3f}, {:.3f}]: check how it is mounted.",
      std::acos(std::min(1.0, upright.dot(down))) * 180.0 / std::numbers::pi, gravity_m_s2.x(),
      gravity_m_s2.y(), gravity_m_s2.z());
  cause.torque_Nm = jointRms(data, explained.torque);
  return Suspicion{std::move(cause), explained.share};
}

// By less than what is refused.
std::optional<Suspicion> lateTorque(const Dataset& data, const ModelFit& fit) {
  // Of what the fit explains: the noise of the measured torque changes faster than any motion.
  const Column rate = rateOf(data, data.driveTorque() - fit.residual);
  const Explained explained = explainedBy(data, fit, Column::Zero(rate.size()), -rate);
  // Drives that are late are effects of the library.
  if (explained.sizes[0] <= 0.0) {
    return {};
  }
  SharedCause cause;
  cause.torque_late_s = explained.sizes[0];
  cause.torque_Nm = jointRms(data, explained.torque);
  cause.words = fmt::format("All torque columns come {:.2g} ms late: check their filters and times.",
                            1e3 * cause.torque_late_s);
  return Suspicion{std::move(cause), explained.share};
}

// A cause that explains more than a share of what a fit leaves.
std::optional<SharedCause> likeliest(const Dataset& data, const model::ModelDescription& given,
                                     const ModelFit& fit, double least_share) {
  std::optional<Suspicion> base = tiltedBase(data, given, fit, least_share), late = lateTorque(data, fit);
  std::optional<Suspicion>& likelier = late && (!base || late->share > base->share) ? late : base;
  return likelier && likelier->share > least_share ? std::optional(std::move(likelier->cause)) : std::nullopt;
}

auto assertedIn(const Diagnosis& diagnosis) {
  return std::count_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                       [](const EffectFinding& effect) { return effect.asserted(); });
}

}  // namespace

double leftBy(const Diagnosis& diagnosis) {
  double left = 0.0;
  for (std::size_t joint = 0; joint < diagnosis.rests.size(); ++joint) {
    left += std::pow(diagnosis.noise_floor_Nm[joint] / std::max(1e-12, diagnosis.rests[joint].torque_Nm), 2);
  }
  return left;
}

model::ModelDescription SharedCause::takenOutOf(model::ModelDescription model) const {
  return gravity_m_s2 ? withBaseGravity(std::move(model), *gravity_m_s2) : model;
}

std::vector<Recording> SharedCause::takenOutOf(std::span<const Recording> recordings) const {
  std::vector<Recording> earlier(recordings.begin(), recordings.end());
  if (torque_late_s == 0.0) {
    return earlier;
  }
  for (Recording& recording : earlier) {
    for (std::vector<double>& column : recording.torque_Nm) {
      for (const Segment& segment : column.empty() ? std::vector<Segment>{} : recording.segments) {
        const std::span<double> late(column.data() + segment.first, segment.end - segment.first);
        const auto in_time = offline::advanced(late, torque_late_s, recording.rate_Hz);
        std::copy(in_time.begin(), in_time.end(), late.begin());
      }
    }
  }
  return earlier;
}

std::optional<SharedCause> suspectedCause(const Dataset& data, double least_late_s,
                                          const model::ModelDescription& given, const ModelFit& nominal,
                                          const ModelFit& found, const Diagnosis& diagnosis) {
  if (data.isStatic() || data.joints() == 1) {
    return {};
  }
  const bool much_is_left = std::any_of(
      diagnosis.rests.begin(), diagnosis.rests.end(),
      [](const RestOfJoint& rest) { return rest.structure_Nm > unknown::kLikeNoise * rest.noise_Nm; });
  std::optional<SharedCause> cause;
  if (much_is_left) {
    cause = likeliest(data, given, found, shared::kSuspected);
  }
  if (!cause && assertedIn(diagnosis) > 1) {
    cause = likeliest(data, given, nominal, unknown::kGoesWith);
  }
  if (cause && !cause->isOfBase()) {
    cause->may_be_reading = cause->torque_late_s < least_late_s;
  }
  return cause;
}

bool bearsOut(const Diagnosis& taken_out, const Diagnosis& as_given) {
  if (taken_out.verdict == Verdict::kInsufficientExcitation || taken_out.rests.empty()) {
    return false;
  }
  const double left = leftBy(taken_out), before = leftBy(as_given);
  return left < shared::kSuspected * before ||
         (left < shared::kAsLittle * before && assertedIn(taken_out) + 1 < assertedIn(as_given));
}

Diagnosis withCauses(std::span<const SharedCause> causes, Diagnosis taken_out, const Diagnosis& before) {
  std::string words;
  for (const SharedCause& cause : causes) {
    if (cause.may_be_reading) {
      taken_out.warnings.push_back(cause.words +
                                   " That is less than half a sample, and taken for how the rows were read.");
    } else {
      words += cause.words + " ";
    }
  }
  taken_out.before = before.before;
  taken_out.refitted = before.refitted;
  if (!words.empty()) {
    taken_out.doubts.push_back(
        {Doubt::kSharedCause, words + "With that taken out: " + taken_out.explanation});
    taken_out.remarks.clear();  // they stand in the explanation
    settle(taken_out);
  }
  return taken_out;
}

}  // namespace patella::diagnose
