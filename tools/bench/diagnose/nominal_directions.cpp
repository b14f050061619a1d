#include "tools/bench/diagnose/nominal_directions.hpp"

#include <algorithm>
#include <array>

#include <Eigen/QR>

#include "tools/bench/diagnose/inverse_dynamics.hpp"
#include "tools/bench/diagnose/random.hpp"

namespace patella::bench {
namespace {

using Directions = std::vector<std::pair<Body, Body>>;

Directions ofChain(const Body& body) {
  // Masses and places of about the links' size, so that no column is small.
  constexpr double kMass_kg = 1.0, kAway_m = 0.3;
  std::vector<Eigen::Vector3d> places;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = kAway_m * Eigen::Vector3d::Unit(axis);
    places.insert(places.end(), {along, -along, along + kAway_m * Eigen::Vector3d::Unit((axis + 1) % 3)});
  }
  places.emplace_back(Eigen::Vector3d::Zero());
  Directions directions;
  for (std::size_t joint = 0; joint < body.joints(); ++joint) {
    for (const Eigen::Vector3d& place : places) {
      Body heavier = body;
      addPointMass(heavier.chain.links[linkOfJoint(body.chain, joint)], kMass_kg, place);
      directions.emplace_back(std::move(heavier), body);
    }
  }
  return directions;
}

// The torque that an effect of the size of one unit takes from the drives, at one state.
PerJoint columnOf(const TrueEffect& effect, InverseDynamics& dynamics, const PerJoint& q, const PerJoint& dq,
                  const PerJoint& ddq) {
  const std::size_t j = effect.joint;
  PerJoint column{};
  if (effect.kind == Kind::kRotor) {
    column[j] = ddq[j];
  } else if (effect.kind == Kind::kGain) {
    column[j] = dynamics(q, dq, ddq)[j];
  } else if (effect.kind == Kind::kBias) {
    column[j] = 1.0;
  } else {  // kOffset
    constexpr double kStep_rad = 1e-4;
    PerJoint more = q, less = q;
    more[j] += kStep_rad;
    less[j] -= kStep_rad;
    const PerJoint high = dynamics(more, dq, ddq), low = dynamics(less, dq, ddq);
    for (std::size_t i = 0; i < kJoints; ++i) {
      column[i] = (high[i] - low[i]) / (2.0 * kStep_rad);
    }
  }
  return column;
}

bool inSpanOfChain(const TrueEffect& effect, Body body) {
  body.damping_Nms_rad = {};
  constexpr int kStates = 40;
  const auto joints = static_cast<Eigen::Index>(body.joints());
  const Directions directions = ofChain(body);
  InverseDynamics dynamics(body);
  std::vector<InverseDynamics> changed;
  for (const auto& [more, less] : directions) {
    changed.emplace_back(more);
  }
  Eigen::MatrixXd span(kStates * joints, static_cast<Eigen::Index>(directions.size()));
  Eigen::VectorXd wanted(kStates * joints);
  Random random(1);
  for (int state = 0; state < kStates; ++state) {
    PerJoint q{}, dq{}, ddq{};
    for (std::size_t j = 0; j < body.joints(); ++j) {
      q[j] = random.uniform(-1.0, 1.0);
      dq[j] = random.uniform(-2.0, 2.0);
      ddq[j] = random.uniform(-10.0, 10.0);
    }
    const PerJoint plain = dynamics(q, dq, ddq);
    const PerJoint column = columnOf(effect, dynamics, q, dq, ddq);
    const auto rowsOf = [&](const PerJoint& values) {
      return Eigen::Map<const Eigen::VectorXd>(values.data(), joints);
    };
    wanted.segment(state * joints, joints) = rowsOf(column);
    for (std::size_t k = 0; k < changed.size(); ++k) {
      span.col(static_cast<Eigen::Index>(k)).segment(state * joints, joints) =
          rowsOf(changed[k](q, dq, ddq)) - rowsOf(plain);
    }
  }
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> basis(span);
  constexpr double kNothing = 1e-5;
  return (wanted - span * basis.solve(wanted)).norm() < kNothing * wanted.norm();
}

}  // namespace

Directions nominalDirections(const Body& body) {
  if (body.shape == Shape::kChain) {
    return ofChain(body);
  }
  Directions directions;
  const auto vary = [&](const auto& parameter) {
    constexpr double kShare = 1e-3;
    Body more = body, less = body;
    parameter(more) *= 1.0 + kShare;
    parameter(less) *= 1.0 - kShare;
    directions.emplace_back(std::move(more), std::move(less));
  };
  if (body.shape == Shape::kRevolute) {
    vary([](Body& changed) -> double& { return changed.moment_kg_m; });
    vary([](Body& changed) -> double& { return changed.inertia_kg_m2[0]; });
  } else if (body.shape == Shape::kPrismatic) {
    vary([](Body& changed) -> double& { return changed.mass_kg[0]; });
  } else {
    for (Pair Body::*const member : {&Body::mass_kg, &Body::com_m, &Body::inertia_kg_m2}) {
      for (std::size_t i = 0; i < 2; ++i) {
        vary([member, i](Body& changed) -> double& { return (changed.*member)[i]; });
      }
    }
  }
  return directions;
}

bool inSpan(const TrueEffect& effect, const Body& body) {
  if (effect.kind == Kind::kPayload) {
    return true;
  }
  if (body.shape == Shape::kChain) {
    constexpr std::array kAsked{Kind::kRotor, Kind::kGain, Kind::kBias, Kind::kOffset};
    return std::find(kAsked.begin(), kAsked.end(), effect.kind) != kAsked.end() &&
           inSpanOfChain(effect, body);
  }
  return (effect.kind == Kind::kRotor && effect.joint == 0) ||
         (effect.kind == Kind::kGain && body.shape != Shape::kLeg);
}

}  // namespace patella::bench
