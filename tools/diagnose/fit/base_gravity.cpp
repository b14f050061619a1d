#include "tools/diagnose/fit/base_gravity.hpp"

#include <variant>
#include <vector>

namespace patella::diagnose {
namespace {

std::vector<model::SerialChainParameters*> chainsOf(model::ModelDescription& model) {
  if (auto* chain = std::get_if<model::SerialChainParameters>(&model.mechanism)) {
    return {chain};
  }
  std::vector<model::SerialChainParameters*> chains;
  if (auto* group = std::get_if<model::ChainGroupParameters>(&model.mechanism)) {
    for (model::SerialChainParameters& chain : group->chains) {
      chains.push_back(&chain);
    }
  }
  return chains;
}

}  // namespace

std::optional<Eigen::Vector3d> baseGravity(const model::ModelDescription& model) {
  model::ModelDescription own = model;
  const std::vector<model::SerialChainParameters*> chains = chainsOf(own);
  return chains.empty() || chains.front()->gravity_m_s2.isZero(0.0)
             ? std::nullopt
             : std::optional<Eigen::Vector3d>(chains.front()->gravity_m_s2);
}

model::ModelDescription withBaseGravity(model::ModelDescription model, const Eigen::Vector3d& gravity_m_s2) {
  for (model::SerialChainParameters* chain : chainsOf(model)) {
    chain->gravity_m_s2 = gravity_m_s2;
  }
  return model;
}

}  // namespace patella::diagnose
