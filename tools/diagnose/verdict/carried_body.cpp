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

constexpr int kRounds = 5;
constexpr double kUnit_kg = 1.0;
constexpr double kDifference_m = 0.05;

Eigen::Matrix3d pointInertia(double mass_kg, const Eigen::Vector3d& from_m) {
  return mass_kg * (from_m.squaredNorm() * Eigen::Matrix3d::Identity() - from_m * from_m.transpose());
}

model::ChainLink withPoint(model::ChainLink link, double mass_kg, const Eigen::Vector3d& at_m) {
  const Eigen::Vector3d own(link.com_m[0], link.com_m[1], link.com_m[2]);
  const double whole_kg = link.mass_kg + mass_kg;
  const Eigen::Vector3d centre = (link.mass_kg * own + mass_kg * at_m) / whole_kg;
  const Eigen::Matrix3d added =
      pointInertia(link.mass_kg, own - centre) + pointInertia(mass_kg, at_m - centre);
  link.mass_kg = whole_kg;
  link.com_m = {centre.x(), centre.y(), centre.z()};
  link.inertia_kg_m2[0] += added(0, 0);
  link.inertia_kg_m2[1] += added(1, 1);
  link.inertia_kg_m2[2] += added(2, 2);
  link.inertia_kg_m2[3] += added(0, 1);
  link.inertia_kg_m2[4] += added(0, 2);
  link.inertia_kg_m2[5] += added(1, 2);
  return link;
}

/// Torque of a kilogram at a point of the last link.
class PointTorque {
 public:
  PointTorque(const Dataset& data, const model::ModelDescription& given)
      : data_(data), bare_{.mechanism = given.mechanism, .effects = {}}, own_(torqueOf(bare_)) {}

  Column at(const Eigen::Vector3d& point_m) const {
    return torqueOf(withBody(bare_, {.mass_kg = kUnit_kg, .at_m = point_m})) - own_;
  }

  /// Change by a metre along each axis: exact, as the torque is quadratic in the place.
  Eigen::MatrixXd slopes(const Eigen::Vector3d& point_m) const {
    Eigen::MatrixXd columns(own_.size(), 3);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d aside = kDifference_m * Eigen::Vector3d::Unit(axis);
      columns.col(axis) = (at(point_m + aside) - at(point_m - aside)) / (2.0 * kDifference_m);
    }
    return columns;
  }

 private:
  Column torqueOf(const model::ModelDescription& model) const {
    model::DynamicsModel dynamics = model::makeModel(model);
    return data_.mechanismTorque(dynamics.mechanism(), JointVector::Zero(data_.joints()));
  }

  const Dataset& data_;
  model::ModelDescription bare_;
  Column own_;
};

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
          .covariance = fit.prior_scale * fit.prior_scale *
                        (unit.asDiagonal() * inverse.bottomRightCorner<4, 4>() * unit.asDiagonal())};
}

// Squared standard deviations by which a fit moved each parameter of its model off what is known of it.
Eigen::ArrayXd movedBy(const ModelFit& fit) {
  return fit.prior_residual.array().square() / (fit.prior_scale * fit.prior_scale);
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
bool isPayload(const CarriedBody& body) {
  return body.mass_kg < physicalRange("payload", "mass_kg")[1] &&
         body.at_m.norm() < physicalRange("payload", "distance_m")[1];
}

std::array<double, 2> interval(double value, double variance) {
  const double half = asserted::kShapeAllowance * rivals::kWithin95 * std::sqrt(std::max(variance, 0.0));
  return {value - half, value + half};
}

}  // namespace

model::ModelDescription withBody(model::ModelDescription model, const CarriedBody& body) {
  if (auto* chain = std::get_if<model::SerialChainParameters>(&model.mechanism)) {
    chain->links.back() = withPoint(chain->links.back(), body.mass_kg, body.at_m);
  }
  return model;
}

std::optional<CarriedBody> suspectedBody(const Dataset& data, const model::ModelDescription& given,
                                         const FitOptions& options, const Diagnosis& diagnosis) {
  if (!std::holds_alternative<model::SerialChainParameters>(given.mechanism) || data.isStatic()) {
    return std::nullopt;
  }
  const model::ModelDescription model = besideBody(given, diagnosis);
  ModelFit fit = ModelFitter(data, model, options).nominal();
  const Eigen::ArrayXd moved = movedBy(fit);
  if (moved.size() == 0 || moved.maxCoeff() < std::pow(runaway::kWithinTolerance, 2)) {
    return std::nullopt;
  }
  const PointTorque torque(data, given);
  CarriedBody body;
  Step step;
  for (int round = 0; round < kRounds; ++round) {
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
    fit = ModelFitter(data, withBody(model, body), options).nominal();
  }
  const double still_moved = movedBy(fit).sum();
  if (still_moved > (1.0 - shared::kSuspected) * moved.sum()) {
    return std::nullopt;
  }
  body.gain_nats = 0.5 * (moved.sum() - still_moved);
  const double distance_m = body.at_m.norm();
  const Eigen::Vector3d outwards = body.at_m / std::max(distance_m, 1e-9);
  body.mass_ci95_kg = interval(body.mass_kg, step.covariance(0, 0));
  body.distance_ci95_m =
      interval(distance_m, outwards.dot(step.covariance.bottomRightCorner<3, 3>() * outwards));
  return body;
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

Diagnosis withBodyFound(const CarriedBody& body, Diagnosis with_body, const Diagnosis& before) {
  with_body.before = before.before;
  with_body.refitted = before.refitted;
  EffectFinding finding{
      .kind = "payload",
      .joint = static_cast<int>(before.before.train_rms_Nm.size()) - 1,
      .parameters = {{.name = "mass_kg", .value = body.mass_kg, .ci95 = body.mass_ci95_kg},
                     {.name = "distance_m", .value = body.at_m.norm(), .ci95 = body.distance_ci95_m}},
      .p_value = accepted::kFamilyWiseP,
      .gain = body.gain_nats,
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
      body.mass_kg, body.at_m.x(), body.at_m.y(), body.at_m.z(), beside);
  return with_body;
}

}  // namespace patella::diagnose
