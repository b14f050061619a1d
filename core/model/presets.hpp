// Legs with known parameters, for simulation, tests and as a starting point of a model file.
#pragma once

#include "core/model/dynamics_model.hpp"
#include "core/model/planar_two_link.hpp"

namespace patella::model {

struct LegPreset {
  PlanarTwoLinkParameters parameters;
  double viscous_Nms_rad;  ///< known friction of each joint
};

/// The paper's Section 5: masses and lengths as given, uniform mass (l_c = l/2), I = m l²/4. Open loop it
/// stays near hanging only with the damping of 0.2 N·m·s/rad.
LegPreset paperLeg();

/// The same inertias with the friction of a light drive, for closed-loop motion.
LegPreset physicalLeg();

/// Thigh, and shank with foot, of an adult of 72 kg (7.2 and 4.4 kg), segments of 0.4 m: fractions of body
/// mass and of segment length from Winter, Biomechanics and Motor Control of Human Movement, 4th ed.,
/// Table 4.1 (after Dempster).
LegPreset adultLeg();

/// The preset with viscous friction on both joints.
DynamicsModel makeModel(const LegPreset& preset);

}  // namespace patella::model
