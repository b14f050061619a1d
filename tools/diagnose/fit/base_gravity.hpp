// Gravity at the base of chains: which way is down there.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/model_description.hpp"

namespace patella::diagnose {

/// m/s², of the first chain; nothing for mechanisms whose base has no angle, or without gravity.
std::optional<Eigen::Vector3d> baseGravity(const model::ModelDescription& model);

/// Of every chain. Other mechanisms stay as they are.
model::ModelDescription withBaseGravity(model::ModelDescription model, const Eigen::Vector3d& gravity_m_s2);

}  // namespace patella::diagnose
