// The numbers of a mechanism in a model file. Those of effects stand with each effect,
// model::effectCatalogue().
#pragma once

#include <array>
#include <numbers>

#include "core/bounds/bound.hpp"

namespace patella::bounds {

// One row a line.
// clang-format off
inline constexpr std::array kModel{
    number("mechanism.gravity_m_s2", "m/s²", 0, 10, "9.78 to 9.83 on Earth; 0 lies flat or is weighed out"),
    number("mechanism.mass_kg (planar_two_link)", "kg", 1e-3, 50, "a thigh of 20 with the heaviest cuff and frame; a light arm has 0.1"),
    number("mechanism.length_m (planar_two_link)", "m", 0.01, 2, "twice the longest thigh; a finger's"),
    number("mechanism.com_m (planar_two_link)", "m", 0, 2, "on the link or a frame beyond it"),
    number("mechanism.inertia_kg_m2 (planar_two_link)", "kg·m²", 0, 20, "50 kg with a radius of gyration of 0.6 m; 0 for a point"),
    number("mechanism.base_parameters.thigh_inertia_kg_m2 (planar_two_link)", "kg·m²", 1e-7, 420, "20 with 50 kg at 2 m, and the shank's 50 kg at 2 m; the lightest link"),
    number("mechanism.base_parameters.shank_inertia_kg_m2 (planar_two_link)", "kg·m²", 1e-7, 220, "20 with 50 kg at 2 m; the lightest link"),
    number("mechanism.base_parameters.thigh_moment_kg_m (planar_two_link)", "kg·m", 0, 200, "50 kg at 2 m, and the shank's 50 kg at 2 m"),
    number("mechanism.base_parameters.shank_moment_kg_m (planar_two_link)", "kg·m", 0, 100, "50 kg at 2 m; 0 for a balanced link"),
    number("mechanism.inertia_kg_m2 (revolute)", "kg·m²", 1e-5, 20, "as above; a small motor's rotor"),
    number("mechanism.moment_kg_m (revolute)", "kg·m", 0, 50, "50 kg at 1 m: 490 N·m of weight"),
    number("mechanism.length_m (revolute)", "m", 0.01, 2, "as a link's"),
    number("mechanism.mass_kg (prismatic)", "kg", 1e-3, 1000, "a carriage; the benchmark's has 95"),
    number("mechanism.inclination_rad (prismatic)", "rad", -std::numbers::pi, std::numbers::pi, "half a turn either way is every direction"),
    number("mechanism.gravity_m_s2 (serial_chain)", "m/s²", -10, 10, "of the vector in the base's frame, whose magnitude has the range above"),
    number("mechanism.link.origin_m (serial_chain)", "m", -10, 10, "a rail of 10 m"),
    number("mechanism.link.turn_rad (serial_chain)", "rad", -2 * std::numbers::pi, 2 * std::numbers::pi, "a turn either way is every direction"),
    number("mechanism.link.axis (serial_chain)", "", -1, 1, "of a direction; its length is without effect, but not 0"),
    number("mechanism.link.mass_kg (serial_chain)", "kg", 0, 1000, "a frame without a body; as a carriage's"),
    number("mechanism.link.com_m (serial_chain)", "m", -10, 10, "as the origin's"),
    number("mechanism.link.inertia_kg_m2 (serial_chain)", "kg·m²", -1000, 1000, "1000 kg with a radius of gyration of 1 m; products of inertia have either sign"),
};
// clang-format on

}  // namespace patella::bounds
