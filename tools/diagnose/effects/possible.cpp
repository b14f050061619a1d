#include "tools/diagnose/effects/possible.hpp"

#include <cmath>
#include <variant>
#include <vector>

namespace patella::diagnose {
namespace {

/// Sine of the angle between parallel axes, at most: files give angles to four digits.
constexpr double kParallel = 1e-2;

std::vector<bool> kneesOf(const model::SerialChainParameters& chain) {
  std::vector<bool> knees;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();  // axis of the joint before, in the present link's frame
  for (const model::ChainLink& link : chain.links) {
    before = model::rotationOf(link.turn_rad).transpose() * before;
    if (link.joint == model::ChainJoint::kFixed) {
      continue;
    }
    const bool turns = link.joint == model::ChainJoint::kRevolute;
    const Eigen::Vector3d axis = link.axis.normalized();
    const bool in_plane = before.norm() > 0.0 && before.cross(axis).norm() < kParallel;
    knees.push_back(turns && (in_plane || chain.joints() == 1));
    before = turns ? axis : Eigen::Vector3d::Zero();
  }
  return knees;
}

std::vector<bool> kneesOf(const model::ChainGroupParameters& group) {
  std::vector<bool> knees;
  for (const model::SerialChainParameters& chain : group.chains) {
    const std::vector<bool> own = kneesOf(chain);
    knees.insert(knees.end(), own.begin(), own.end());
  }
  return knees;
}

std::vector<bool> kneesOf(const model::PlanarTwoLinkParameters& /*leg*/) {
  return {false, true};
}
std::vector<bool> kneesOf(const model::RevoluteJointParameters& /*joint*/) {
  return {true};
}
std::vector<bool> kneesOf(const model::PrismaticJointParameters& /*axis*/) {
  return {false};
}

}  // namespace

bool mayHave(const EffectHome& home, const model::MechanismDescription& mechanism, int joint) {
  if (home.of_knee) {
    return std::visit([](const auto& parameters) { return kneesOf(parameters); },
                      mechanism)[static_cast<std::size_t>(joint)];
  }
  if (home.along_segment) {
    return model::makeModel({.mechanism = mechanism, .effects = {}}).mechanism().hasSegment(joint);
  }
  return !home.of_patient || !model::isPrismatic(mechanism, joint);
}

}  // namespace patella::diagnose
