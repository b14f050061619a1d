#include "tools/bench/plan/draw_machine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/bench/diagnose/random.hpp"

namespace patella::bench {
namespace {

constexpr int kChainJoints = 3;

model::ModelDescription drawModel(Random& random, std::string& name) {
  model::ModelDescription model;
  const double lot = random.uniform();
  if (lot < 0.3) {
    name = "knee";
    const double mass_kg = random.logUniform(1.0, 6.0), length_m = random.uniform(0.25, 0.45);
    const double com_m = random.uniform(0.4, 0.6) * length_m;
    model.mechanism = model::RevoluteJointParameters{
        .inertia_kg_m2 = mass_kg * (com_m * com_m + 0.09 * length_m * length_m),
        .moment_kg_m = mass_kg * com_m,
        .length_m = length_m};
  } else if (lot < 0.4) {
    name = "rail";
    model.mechanism = model::PrismaticJointParameters{.mass_kg = random.logUniform(5.0, 100.0),
                                                      .inclination_rad = random.uniform(0.0, 1.2)};
  } else if (lot < 0.8) {
    name = "leg";
    model::PlanarTwoLinkParameters leg;
    leg.mass_kg[0] = random.logUniform(0.5, 9.0);
    leg.mass_kg[1] = random.uniform(0.4, 0.8) * leg.mass_kg[0];
    for (std::size_t link = 0; link < 2; ++link) {
      leg.length_m[link] = random.uniform(0.2, 0.45);
      leg.com_m[link] = random.uniform(0.4, 0.6) * leg.length_m[link];
      leg.inertia_kg_m2[link] = leg.mass_kg[link] * std::pow(0.3 * leg.length_m[link], 2);
    }
    model.mechanism = leg;
  } else {
    name = "chain of 3";
    model::SerialChainParameters chain;
    for (int link = 0; link < kChainJoints; ++link) {
      const double mass_kg = random.uniform(1.0, 4.0) / (1.0 + link), length_m = random.uniform(0.2, 0.4);
      const double across = mass_kg * std::pow(0.1 * length_m, 2),
                   along = mass_kg * std::pow(0.3 * length_m, 2);
      chain.links.push_back({.name = "link " + std::to_string(link + 1),
                             .joint = model::ChainJoint::kRevolute,
                             .origin_m = {link == 0 ? 0.0 : length_m, 0.0, 0.0},
                             // The joints' axes stand across each other, as those of a hip.
                             .turn_rad = {link % 2 == 1 ? 0.5 * std::numbers::pi : 0.0, 0.0, 0.0},
                             .axis = {0.0, 0.0, 1.0},
                             .mass_kg = mass_kg,
                             .com_m = {0.5 * length_m, 0.1 * length_m, 0.05 * length_m},
                             .inertia_kg_m2 = {across, along, along, 0.0, 0.0, 0.0}});
    }
    chain.links.push_back(
        {.name = "end point", .joint = model::ChainJoint::kFixed, .origin_m = {0.3, 0.0, 0.0}});
    chain.gravity_m_s2 = {0.0, -9.81, 0.0};
    model.mechanism = chain;
  }
  return model;
}

// Everything that a maker's table gives, a little wrong.
struct Wrong {
  Random& random;
  double operator()(double value) const { return value * random.uniform(0.95, 1.05); }
  void operator()(model::RevoluteJointParameters& knee) const {
    knee.inertia_kg_m2 = (*this)(knee.inertia_kg_m2);
    knee.moment_kg_m = (*this)(knee.moment_kg_m);
  }
  void operator()(model::PrismaticJointParameters& rail) const { rail.mass_kg = (*this)(rail.mass_kg); }
  void operator()(model::PlanarTwoLinkParameters& leg) const {
    for (std::size_t link = 0; link < 2; ++link) {
      leg.mass_kg[link] = (*this)(leg.mass_kg[link]);
      leg.com_m[link] = (*this)(leg.com_m[link]);
      leg.inertia_kg_m2[link] = (*this)(leg.inertia_kg_m2[link]);
    }
  }
  void operator()(model::SerialChainParameters& chain) const {
    for (model::ChainLink& link : chain.links) {
      const double factor = (*this)(1.0);
      link.mass_kg *= factor;
      for (double& moment : link.inertia_kg_m2) {
        moment *= factor;
      }
      link.com_m *= (*this)(1.0);
    }
  }
  void operator()(model::ChainGroupParameters& group) const {
    for (model::SerialChainParameters& chain : group.chains) {
      (*this)(chain);
    }
  }
};

}  // namespace

Machine drawMachine(std::uint64_t seed) {
  constexpr std::uint64_t kStream = 71;
  Random random(seed, kStream);
  Machine machine;
  machine.nominal = drawModel(random, machine.name);
  machine.truth = machine.nominal;
  std::visit(Wrong{random}, machine.truth.mechanism);
  const model::DynamicsModel dynamics = model::makeModel(machine.nominal);
  const int joints = dynamics.joints();
  machine.start_rad.resize(joints);
  for (int j = 0; j < joints; ++j) {
    safety::JointLimits& limit = machine.limits.joint[static_cast<std::size_t>(j)];
    const bool rail = machine.name == "rail";
    const double middle = rail ? 0.0 : random.uniform(-1.2, 0.2);
    const double half = rail ? random.uniform(0.2, 0.5) : random.uniform(0.6, 1.3);
    limit = {.torque_Nm = 0.0,
             .torque_rate_Nm_s = 1e4,
             .velocity_rad_s = rail ? random.uniform(0.8, 2.0) : random.uniform(2.5, 6.0),
             .q_min_rad = middle - half,
             .q_max_rad = middle + half,
             .soft_margin_rad = rail ? 0.01 : 0.05};
    machine.start_rad[j] = middle;
  }
  // A drive holds its joint in every pose, and accelerates it besides.
  JointVector heaviest_Nm = JointVector::Zero(joints);
  JointVector inertia = JointVector::Zero(joints);
  constexpr int kPoses = 200;
  for (int pose = 0; pose < kPoses; ++pose) {
    JointVector q(joints);
    for (int j = 0; j < joints; ++j) {
      const safety::JointLimits& limit = machine.limits.joint[static_cast<std::size_t>(j)];
      q[j] = random.uniform(limit.q_min_rad, limit.q_max_rad);
    }
    heaviest_Nm = heaviest_Nm.cwiseMax(dynamics.mechanism().gravity(q).cwiseAbs());
    inertia = inertia.cwiseMax(dynamics.mechanism().inertia(q).diagonal());
  }
  for (int j = 0; j < joints; ++j) {
    machine.limits.joint[static_cast<std::size_t>(j)].torque_Nm =
        1.5 * heaviest_Nm[j] + random.uniform(8.0, 25.0) * inertia[j];
  }
  return machine;
}

}  // namespace patella::bench
