#include "tools/diagnose/verdict/carried_body.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <variant>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/shared_cause.hpp"
#include "tools/diagnose/verdict/verdict.hpp"

namespace patella::diagnose {
namespace {

constexpr int kBodyRounds = 5;

struct Step {
  Eigen::Vector4d change;
  Eigen::Matrix4d covariance;
};

// By columns of the body, beside all that the fit estimates.
Step stepOf(const ModelFit& fit, const Eigen::MatrixXd& columns) {
  const FreeColumns free = freeColumns(fit, fit.prior_weight, columns);
  Eigen::VectorXd wanted(free.weighted.rows());
  wanted << fit.weighting->apply(fit.residual), fit.prior_residual;
  const Eigen::VectorXd scaled = free.weighted.completeOrthogonalDecomposition().solve(wanted);
  const Eigen::MatrixXd inverse =
      (free.weighted.transpose() * free.weighted).completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::Vector4d unit = free.length.tail<4>().cwiseInverse();
  return {.change = scaled.tail<4>().cwiseProduct(unit),
          .covariance =
              fit.redundancy() * (unit.asDiagonal() * inverse.bottomRightCorner<4, 4>() * unit.asDiagonal())};
}

// Squared standard deviations by which a fit moved each parameter of its model off what is known of it.
Eigen::ArrayXd movedBy(const ModelFit& fit) {
  return fit.prior_residual.array().square() / fit.redundancy();
}

// The given model with the friction that was found: it acts beside any body. What goes with the position may
// stand for one.
model::ModelDescription besideBody(const model::ModelDescription& given, const Diagnosis& diagnosis) {
  model::ModelDescription model{.mechanism = given.mechanism, .effects = {}};
  std::copy_if(diagnosis.extended.effects.begin(), diagnosis.extended.effects.end(),
               std::back_inserter(model.effects),
               [](const model::EffectDescription& effect) { return betrayingVariable(effect.kind) == "dq"; });
  return model;
}

double movedIn(const Diagnosis& diagnosis) {
  double moved = 0.0;
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    if (parameter.known_sd > 0.0) {
      moved += std::pow((parameter.refitted - parameter.nominal) / parameter.known_sd, 2);
    }
  }
  return moved;
}

// Within what the effect of that name may be, which model files hold.
bool isPayload(const PointBody& body) {
  return body.mass_kg < physicalRange("payload", "mass_kg")[1] &&
         body.at_m.norm() < physicalRange("payload", "distance_m")[1];
}

std::array<double, 2> interval(double value, double variance) {
  const double half = asserted::kShapeAllowance * rivals::kWithin95 * std::sqrt(std::max(variance, 0.0));
  return {value - half, value + half};
}

}  // namespace

std::optional<CarriedBody> suspectedBody(const Dataset& data, const model::ModelDescription& given,
                                         const FitOptions& options, double redundancy,
                                         const Diagnosis& diagnosis) {
  if (!std::holds_alternative<model::SerialChainParameters>(given.mechanism) || data.isStatic()) {
    return std::nullopt;
  }
  const model::ModelDescription model = besideBody(given, diagnosis);
  const auto fitOf = [&](const model::ModelDescription& described) {
    ModelFitter fitter(data, described, options);
    fitter.setRedundancy(redundancy);
    return fitter.nominal();
  };
  ModelFit fit = fitOf(model);
  const Eigen::ArrayXd moved = movedBy(fit);
  if (moved.size() == 0 || moved.maxCoeff() < std::pow(runaway::kWithinTolerance, 2)) {
    return std::nullopt;
  }
  const PointTorque torque(data, given);
  CarriedBody found;
  PointBody& body = found.body;
  Step step;
  for (int round = 0; round < kBodyRounds; ++round) {
    Eigen::MatrixXd columns(fit.residual.size(), 4);
    // Mass times place at first: without a mass no place matters.
    columns << torque.at(body.at_m), (round == 0 ? 1.0 : body.mass_kg) * torque.slopes(body.at_m);
    step = stepOf(fit, columns);
    body.mass_kg += step.change[0];
    if (!(body.mass_kg > 0.0)) {
      return std::nullopt;
    }
    body.at_m += step.change.tail<3>() / (round == 0 ? body.mass_kg : 1.0);
    if (!isPayload(body)) {
      return std::nullopt;
    }
    fit = fitOf(withBody(model, body));
  }
  const double still_moved = movedBy(fit).sum();
  if (still_moved > (1.0 - shared::kSuspected) * moved.sum()) {
    return std::nullopt;
  }
  found.gain_nats = 0.5 * (moved.sum() - still_moved);
  const double distance_m = body.at_m.norm();
  const Eigen::Vector3d outwards = body.at_m / std::max(distance_m, 1e-9);
  found.mass_ci95_kg = interval(body.mass_kg, step.covariance(0, 0));
  found.distance_ci95_m =
      interval(distance_m, outwards.dot(step.covariance.bottomRightCorner<3, 3>() * outwards));
  return found;
}

bool bodyBearsOut(const Diagnosis& with_body, const Diagnosis& as_given) {
  if (with_body.verdict == Verdict::kInsufficientExcitation || with_body.rests.empty()) {
    return false;
  }
  const double left = leftBy(with_body), before = leftBy(as_given);
  return left < shared::kSuspected * before ||
         (left < shared::kAsLittle * before &&
          movedIn(with_body) < (1.0 - shared::kSuspected) * movedIn(as_given));
}

Diagnosis withBodyFound(const CarriedBody& found, Diagnosis with_body, const Diagnosis& before) {
  with_body.before = before.before;
  with_body.refitted = before.refitted;
  EffectFinding finding{
      .kind = "payload",
      .joint = static_cast<int>(before.before.train_rms_Nm.size()) - 1,
      .parameters = {{.name = "mass_kg", .value = found.body.mass_kg, .ci95 = found.mass_ci95_kg},
                     {.name = "distance_m", .value = found.body.at_m.norm(), .ci95 = found.distance_ci95_m}},
      .gain = found.gain_nats,
      .indistinguishable_from = {},
      .replaces = {},
      .separating_motion = {}};
  settle(with_body);
  const std::string beside = with_body.explanation;
  with_body.effects.insert(with_body.effects.begin(), std::move(finding));
  settle(with_body);
  with_body.explanation = fmt::format(
      "A body of {:.3g} kg on the last link, at [{:.2f}, {:.2f}, {:.2f}] m in its axes, explains what "
      "other masses of all links would have to: a payload, a tool or an orthosis. With it in the model: {}",
      found.body.mass_kg, found.body.at_m.x(), found.body.at_m.y(), found.body.at_m.z(), beside);
  return with_body;
}

}  // namespace patella::diagnose
