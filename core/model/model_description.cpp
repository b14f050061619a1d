#include "core/model/model_description.hpp"

#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/model/effect.hpp"

namespace patella::model {
namespace {

std::unique_ptr<Mechanism> mechanismOf(const PlanarTwoLinkParameters& leg) {
  return std::make_unique<PlanarTwoLink>(leg);
}
std::unique_ptr<Mechanism> mechanismOf(const RevoluteJointParameters& joint) {
  return std::make_unique<RevoluteJoint>(joint);
}
std::unique_ptr<Mechanism> mechanismOf(const PrismaticJointParameters& axis) {
  return std::make_unique<PrismaticJoint>(axis);
}
std::unique_ptr<Mechanism> mechanismOf(const SerialChainParameters& chain) {
  return std::make_unique<SerialChain>(chain);
}
std::unique_ptr<Mechanism> mechanismOf(const ChainGroupParameters& group) {
  return std::make_unique<ChainGroup>(group);
}

int jointsOf(const MechanismDescription& mechanism) noexcept {
  if (const auto* chain = std::get_if<SerialChainParameters>(&mechanism)) {
    return chain->joints();
  }
  if (const auto* group = std::get_if<ChainGroupParameters>(&mechanism)) {
    return group->joints();
  }
  return std::holds_alternative<PlanarTwoLinkParameters>(mechanism) ? 2 : 1;
}

/// Takes the chain's joints off `joint`, which is below 0 once it was found among them.
bool slides(const SerialChainParameters& chain, int& joint) noexcept {
  for (const ChainLink& link : chain.links) {
    if (link.joint != ChainJoint::kFixed && joint-- == 0) {
      return link.joint == ChainJoint::kPrismatic;
    }
  }
  return false;
}

}  // namespace

bool isPrismatic(const MechanismDescription& mechanism, int joint) noexcept {
  if (const auto* chain = std::get_if<SerialChainParameters>(&mechanism)) {
    return slides(*chain, joint);
  }
  if (const auto* group = std::get_if<ChainGroupParameters>(&mechanism)) {
    return std::any_of(group->chains.begin(), group->chains.end(), [&](const SerialChainParameters& chain) {
      return joint >= 0 && slides(chain, joint);
    });
  }
  return std::holds_alternative<PrismaticJointParameters>(mechanism);
}

bool isLinear(const MechanismDescription& mechanism) noexcept {
  for (int joint = 0; joint < jointsOf(mechanism); ++joint) {
    if (!isPrismatic(mechanism, joint)) {
      return false;
    }
  }
  return true;
}

int ModelDescription::joints() const noexcept {
  return jointsOf(mechanism);
}

DynamicsModel makeModel(const ModelDescription& description) {
  std::unique_ptr<Mechanism> mechanism =
      std::visit([](const auto& parameters) { return mechanismOf(parameters); }, description.mechanism);
  std::vector<std::unique_ptr<Effect>> effects;
  for (const EffectDescription& effect : description.effects) {
    effects.push_back(makeEffect(effect.kind, effect.joint, *mechanism, effect.parameters));
  }
  return {std::move(mechanism), std::move(effects)};
}

ModelDescription describeModel(const DynamicsModel& dynamics) {
  ModelDescription description;
  const Mechanism* mechanism = &dynamics.mechanism();
  if (const auto* leg = dynamic_cast<const PlanarTwoLink*>(mechanism)) {
    description.mechanism = leg->parameters();
  } else if (const auto* joint = dynamic_cast<const RevoluteJoint*>(mechanism)) {
    description.mechanism = joint->parameters();
  } else if (const auto* axis = dynamic_cast<const PrismaticJoint*>(mechanism)) {
    description.mechanism = axis->parameters();
  } else if (const auto* chain = dynamic_cast<const SerialChain*>(mechanism)) {
    description.mechanism = chain->parameters();
  } else if (const auto* group = dynamic_cast<const ChainGroup*>(mechanism)) {
    description.mechanism = group->parameters();
  } else {
    throw std::invalid_argument(
        "this mechanism has no form in model files, expected one of 'planar_two_link', "
        "'revolute', 'prismatic', 'serial_chain'");
  }
  for (const auto& effect : dynamics.effects()) {
    const std::span<const double> values = effect->parameters();
    description.effects.push_back({.kind = std::string(effect->descriptor().kind),
                                   .joint = effect->joint(),
                                   .parameters = {values.begin(), values.end()}});
  }
  return description;
}

}  // namespace patella::model
