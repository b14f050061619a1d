// A model as plain data: mechanism, nominal parameters and effects, to be read, changed and written.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/model/chain_group.hpp"
#include "core/model/dynamics_model.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "core/model/serial_chain.hpp"

namespace patella::model {

struct EffectDescription {
  std::string kind;
  int joint = 0;                   ///< from 0; files count from 1
  std::vector<double> parameters;  ///< in the order of the kind's descriptor
};

using MechanismDescription =
    std::variant<PlanarTwoLinkParameters, RevoluteJointParameters, PrismaticJointParameters,
                 SerialChainParameters, ChainGroupParameters>;

/// One chain, or several on one base: what moves in space rather than in the sagittal plane.
inline bool isSerialChain(const MechanismDescription& mechanism) noexcept {
  return std::holds_alternative<SerialChainParameters>(mechanism) ||
         std::holds_alternative<ChainGroupParameters>(mechanism);
}

/// Whether the joint, from 0, slides: its position is in m and its torque in N.
bool isPrismatic(const MechanismDescription& mechanism, int joint) noexcept;
/// Whether every joint does.
bool isLinear(const MechanismDescription& mechanism) noexcept;

struct ModelDescription {
  MechanismDescription mechanism;
  std::vector<EffectDescription> effects;

  int joints() const noexcept;
};

/// Throws std::invalid_argument when a value is out of its range.
DynamicsModel makeModel(const ModelDescription& description);
/// The inverse of makeModel(). Throws std::invalid_argument for a mechanism that no description can express.
ModelDescription describeModel(const DynamicsModel& dynamics);

}  // namespace patella::model
