#include "tools/diagnose/fit/point_body.hpp"

#include <variant>

namespace patella::diagnose {
namespace {

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

}  // namespace

model::ModelDescription withBody(model::ModelDescription model, const PointBody& body) {
  if (auto* chain = std::get_if<model::SerialChainParameters>(&model.mechanism)) {
    chain->links.back() = withPoint(chain->links.back(), body.mass_kg, body.at_m);
  }
  return model;
}

PointTorque::PointTorque(const Dataset& data, const model::ModelDescription& given)
    : data_(data), bare_{.mechanism = given.mechanism, .effects = {}}, own_(torqueOf(bare_)) {}

Column PointTorque::at(const Eigen::Vector3d& point_m) const {
  return torqueOf(withBody(bare_, {.mass_kg = kUnit_kg, .at_m = point_m})) - own_;
}

Eigen::MatrixXd PointTorque::slopes(const Eigen::Vector3d& point_m) const {
  Eigen::MatrixXd columns(own_.size(), 3);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d aside = kDifference_m * Eigen::Vector3d::Unit(axis);
    columns.col(axis) = (at(point_m + aside) - at(point_m - aside)) / (2.0 * kDifference_m);
  }
  return columns;
}

Column PointTorque::torqueOf(const model::ModelDescription& model) const {
  model::DynamicsModel dynamics = model::makeModel(model);
  return data_.mechanismTorque(dynamics.mechanism(), JointVector::Zero(data_.joints()));
}

}  // namespace patella::diagnose
