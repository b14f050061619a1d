// Two links by the base parameters of a published model, in place of masses and centres of mass.
#pragma once

#include <array>

#include "core/model/planar_two_link.hpp"

namespace patella::app {

/// Parameters of two links that motion can identify: m is a mass, l1 the thigh's length, lc the distance of
/// a centre of mass from its joint, I an inertia about it; 1 is the thigh, 2 the shank.
struct BaseParametersOfLinks {
  double thigh_inertia_kg_m2 = 0.0;  ///< I1 + m1 lc1² + m2 l1²
  double shank_inertia_kg_m2 = 0.0;  ///< I2 + m2 lc2²
  double thigh_moment_kg_m = 0.0;    ///< m1 lc1 + m2 l1
  double shank_moment_kg_m = 0.0;    ///< m2 lc2
};

/// Links with these base parameters. Six numbers with four known: of the masses and inertias that are not
/// negative, those with both centres of mass at the middle of their links, or as near to it as may be. They
/// move as every other choice does. Throws std::invalid_argument where there is none.
model::PlanarTwoLinkParameters linksOf(const BaseParametersOfLinks& base,
                                       const std::array<double, 2>& length_m, double gravity_m_s2);

}  // namespace patella::app
