#include "core/model/presets.hpp"

#include <array>
#include <utility>

namespace patella::model {
namespace {

double squared(double x) {
  return x * x;
}

}  // namespace

LegPreset paperLeg() {
  constexpr std::array mass_kg{2.0, 0.85};
  constexpr std::array length_m{0.20, 0.25};
  return {.parameters = {.mass_kg = mass_kg,
                         .length_m = length_m,
                         .com_m = {length_m[0] / 2.0, length_m[1] / 2.0},
                         .inertia_kg_m2 = {mass_kg[0] * squared(length_m[0]) / 4.0,
                                           mass_kg[1] * squared(length_m[1]) / 4.0}},
          .viscous_Nms_rad = 0.2};
}

LegPreset physicalLeg() {
  return {.parameters = paperLeg().parameters, .viscous_Nms_rad = 0.05};
}

LegPreset adultLeg() {
  constexpr double body_kg = 72.0;
  constexpr double segment_m = 0.4;
  // Winter, Table 4.1: share of body mass; proximal distance of the centre of mass and radius of gyration
  // about it as shares of the segment length ("Thigh", "Foot and leg").
  constexpr std::array mass_share{0.100, 0.061};
  constexpr std::array com_share{0.433, 0.606};
  constexpr std::array gyration_share{0.323, 0.416};
  LegPreset preset{.parameters = {}, .viscous_Nms_rad = 0.5};
  for (std::size_t link = 0; link < 2; ++link) {
    preset.parameters.mass_kg[link] = mass_share[link] * body_kg;
    preset.parameters.length_m[link] = segment_m;
    preset.parameters.com_m[link] = com_share[link] * segment_m;
    preset.parameters.inertia_kg_m2[link] =
        preset.parameters.mass_kg[link] * squared(gyration_share[link] * segment_m);
  }
  return preset;
}

DynamicsModel makeModel(const LegPreset& preset) {
  auto mechanism = std::make_unique<PlanarTwoLink>(preset.parameters);
  std::vector<std::unique_ptr<Effect>> effects;
  for (int joint = 0; joint < mechanism->joints(); ++joint) {
    effects.push_back(makeEffect("viscous_friction", joint, *mechanism, std::array{preset.viscous_Nms_rad}));
  }
  return {std::move(mechanism), std::move(effects)};
}

}  // namespace patella::model
