#include "firmware_app/files/base_parameters.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/bounds/bounds.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr double kLeastMass_kg = boundOf("mechanism.mass_kg (planar_two_link)").minimum;

struct Link {
  double mass_kg = 0.0;
  double com_m = 0.0;
  double inertia_kg_m2 = 0.0;
};

/// A link whose mass is enough for the moment: mass · inertia >= moment².
Link linkOf(double mass_kg, double moment_kg_m, double inertia_about_joint_kg_m2) {
  const double com_m = moment_kg_m / mass_kg;
  return {.mass_kg = mass_kg,
          .com_m = com_m,
          .inertia_kg_m2 = std::max(0.0, inertia_about_joint_kg_m2 - moment_kg_m * com_m)};
}

/// With its centre in the middle of the link, or nearer to the joint where the moment asks for more mass.
double wantedMass_kg(double moment_kg_m, double inertia_kg_m2, double length_m) {
  return std::max({2.0 * moment_kg_m / length_m, moment_kg_m * moment_kg_m / inertia_kg_m2, kLeastMass_kg});
}

}  // namespace

model::PlanarTwoLinkParameters linksOf(const BaseParametersOfLinks& base,
                                       const std::array<double, 2>& length_m, double gravity_m_s2) {
  const double l1 = length_m[0];
  // The shank's mass holds its moment, and leaves the thigh a moment and an inertia of its own.
  const double least_kg = base.shank_moment_kg_m * base.shank_moment_kg_m / base.shank_inertia_kg_m2;
  const double by_moment_kg = base.thigh_moment_kg_m / l1;
  const double by_inertia_kg = base.thigh_inertia_kg_m2 / (l1 * l1);
  const double most_kg = std::min(by_moment_kg, by_inertia_kg);
  if (!(least_kg < most_kg)) {
    throw std::invalid_argument(
        "fit no two links: the shank's mass would be at least shank_moment_kg_m² / shank_inertia_kg_m2 = " +
        formatNumber(least_kg) + " kg and at most " +
        (by_moment_kg < by_inertia_kg ? "thigh_moment_kg_m / length_m[1] = "
                                      : "thigh_inertia_kg_m2 / length_m[1]² = ") +
        formatNumber(most_kg) + " kg, expected the thigh's to include m2 l1 and m2 l1²");
  }
  const double shank_kg =
      std::min(wantedMass_kg(base.shank_moment_kg_m, base.shank_inertia_kg_m2, length_m[1]),
               0.5 * (least_kg + most_kg));
  const Link shank = linkOf(shank_kg, base.shank_moment_kg_m, base.shank_inertia_kg_m2);
  const double moment_kg_m = base.thigh_moment_kg_m - shank_kg * l1;
  const double inertia_kg_m2 = base.thigh_inertia_kg_m2 - shank_kg * l1 * l1;
  const Link thigh = linkOf(wantedMass_kg(moment_kg_m, inertia_kg_m2, l1), moment_kg_m, inertia_kg_m2);
  return {.mass_kg = {thigh.mass_kg, shank.mass_kg},
          .length_m = length_m,
          .com_m = {thigh.com_m, shank.com_m},
          .inertia_kg_m2 = {thigh.inertia_kg_m2, shank.inertia_kg_m2},
          .gravity_m_s2 = gravity_m_s2};
}

}  // namespace patella::app
