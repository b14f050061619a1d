#include "tools/bench/diagnose/kinds.hpp"

#include <algorithm>

namespace patella::bench {
namespace {

// In the order of Kind.
constexpr std::array kTable{
    KindInfo{Kind::kViscous, "viscous_friction", {"coefficient_Nms_rad"}, 0b1, 0b1, true, "dq"},
    KindInfo{Kind::kCoulomb, "coulomb_friction", {"level_Nm"}, 0b1, 0b1, true, "dq"},
    KindInfo{
        Kind::kAsymmetric,
        "asymmetric_friction",
        {"level_positive_Nm", "level_negative_Nm", "viscous_positive_Nms_rad", "viscous_negative_Nms_rad"},
        0b1111,
        0b0011,
        true,
        "dq"},
    KindInfo{Kind::kStribeck,
             "stribeck_friction",
             {"level_Nm", "stribeck_level_Nm", "stribeck_velocity_rad_s"},
             0b011,
             0b111,
             true,
             "dq"},
    KindInfo{Kind::kLoadDependent, "load_dependent_friction", {"coefficient"}, 0b1, 0b1, true, "tau dq"},
    // p[2]: damping of the bristles, N·m·s/rad.
    KindInfo{Kind::kPresliding,
             "presliding_hysteresis",
             {"level_Nm", "stiffness_Nm_rad", "bristle_damping"},
             0b111,
             0b011,
             true,
             "dq q"},
    KindInfo{Kind::kStiffness,
             "linear_stiffness",
             {"stiffness_Nm_rad", "rest_position_rad"},
             0b01,
             0b01,
             true,
             "q"},
    KindInfo{Kind::kPassiveKnee, "passive_knee_moment", {"scale"}, 0b1, 0b0, true, "q"},
    KindInfo{Kind::kPayload, "payload", {"mass_kg", "distance_m"}, 0b01, 0b01, true, "q ddq"},
    KindInfo{Kind::kRotor, "rotor_inertia", {"inertia_kg_m2"}, 0b1, 0b1, true, "ddq"},
    KindInfo{Kind::kElasticity,
             "transmission_elasticity",
             {"stiffness_Nm_rad", "rotor_inertia_kg_m2", "damping_Nms_rad"},
             0b111,
             0b011,
             true,
             "tau ddq"},
    KindInfo{Kind::kBacklash,
             "backlash",
             {"gap_rad", "stiffness_Nm_rad", "damping_Nms_rad", "rotor_inertia_kg_m2"},
             0b0001,
             0b0001,
             true,
             "tau"},
    KindInfo{Kind::kRipple,
             "torque_ripple",
             {"amplitude_Nm", "cycles_per_rad", "phase_rad"},
             0b001,
             0b011,
             true,
             "q"},
    KindInfo{Kind::kGain, "torque_gain", {"gain_error"}, 0b1, 0b1, true, "tau"},
    KindInfo{Kind::kBias, "torque_bias", {"bias_Nm"}, 0b1, 0b1, true, "time"},
    KindInfo{Kind::kLag, "actuator_lag", {"time_constant_s"}, 0b1, 0b1, true, "tau"},
    KindInfo{Kind::kDelay, "actuator_delay", {"delay_s"}, 0b1, 0b1, true, "tau"},
    KindInfo{Kind::kOffset, "encoder_offset", {"offset_rad"}, 0b1, 0b1, true, "q"},
    // p[3]: time in which the phase wanders by 1 rad, s; 0: pure.
    KindInfo{Kind::kTremor,
             "tremor",
             {"amplitude_Nm", "frequency_Hz", "phase_rad", "wander"},
             0b0001,
             0b0011,
             true,
             "time"},
    KindInfo{Kind::kSpasticity,
             "spasticity",
             {"gain_Nms_rad", "threshold_rad_s", "delay_s", "direction"},
             0b0001,
             0b0111,
             true,
             "dq"},
    KindInfo{Kind::kEmg, "emg_torque", {"gain_Nm", "channel", "delay_s"}, 0b001, 0b101, true, "activation"},
    KindInfo{Kind::kThermal,
             "thermal_drift",
             {"offset_Nm", "friction_Nm", "viscous_Nms_rad", "time_constant_s"},
             0b0111,
             0b0111,
             true,
             "time"},
    KindInfo{Kind::kCubicDrag, "cubic_drag", {"coefficient"}, 0b1, 0b0, false, "dq"},
    KindInfo{
        Kind::kVaryingInertia, "position_dependent_inertia", {"inertia_kg_m2"}, 0b1, 0b0, false, "ddq q"},
    KindInfo{Kind::kContact, "one_sided_contact", {"stiffness", "from", "side"}, 0b001, 0b0, false, "q"},
    KindInfo{Kind::kVaryingStiffness,
             "time_varying_stiffness",
             {"stiffness", "rest", "frequency_Hz"},
             0b001,
             0b0,
             false,
             "q time"},
    KindInfo{Kind::kBiarticular, "biarticular_spring", {"stiffness", "rest"}, 0b01, 0b0, false, "other_q"},
    KindInfo{Kind::kRubbingSpot, "rubbing_spot", {"level", "centre", "width"}, 0b001, 0b0, false, "dq q"},
    KindInfo{Kind::kHardeningSpring, "hardening_spring", {"coefficient", "rest"}, 0b01, 0b0, false, "q"},
    KindInfo{Kind::kEmgStiffness,
             "emg_stiffness",
             {"stiffness", "rest", "channel"},
             0b001,
             0b0,
             false,
             "activation q"},
    // A weight that is there from p[1] on.
    KindInfo{Kind::kLoadTakenUp, "load_taken_up", {"torque", "from_s"}, 0b01, 0b0, false, "time", true},
    // Spring and damper in series; p[1]: the time in which it gives way.
    KindInfo{
        Kind::kRelaxingTissue, "relaxing_tissue", {"stiffness", "time_s"}, 0b01, 0b0, false, "q dq", true},
    // Rubs for a third of each period p[1].
    KindInfo{
        Kind::kDraggingBrake, "dragging_brake", {"level", "period_s"}, 0b01, 0b0, false, "time dq", true},
    // Viscous friction that goes with the angle.
    KindInfo{Kind::kEccentricBearing,
             "eccentric_bearing",
             {"coefficient", "cycles_per_rad", "phase"},
             0b001,
             0b0,
             false,
             "dq q",
             true},
    // A spring on one side, of which little comes back.
    KindInfo{Kind::kSnaggingCable,
             "snagging_cable",
             {"stiffness", "from", "side"},
             0b001,
             0b0,
             false,
             "q dq",
             true},
    // Back-EMF: the faster, the less torque.
    KindInfo{Kind::kWeakeningDrive,
             "weakening_drive",
             {"share_at_speed", "speed"},
             0b01,
             0b0,
             false,
             "tau dq",
             true},
    // Nothing comes of a torque that is smaller.
    KindInfo{Kind::kDeadZone, "dead_zone_of_drive", {"torque"}, 0b1, 0b0, false, "tau", true},
    // Less and less comes of a torque as the drive warms up.
    KindInfo{Kind::kDeratingDrive, "derating_drive", {"share", "time_s"}, 0b01, 0b0, false, "tau time", true},
};

static_assert(kTable.back().kind == Kind::kDeratingDrive &&
              kTable.size() == static_cast<std::size_t>(Kind::kDeratingDrive) + 1);

}  // namespace

std::span<const KindInfo> allKinds() noexcept {
  return kTable;
}

const KindInfo& infoOf(Kind kind) noexcept {
  return kTable[static_cast<std::size_t>(kind)];
}

const KindInfo* findKind(std::string_view name) noexcept {
  const auto* found =
      std::find_if(kTable.begin(), kTable.end(), [name](const KindInfo& info) { return info.name == name; });
  return found == kTable.end() ? nullptr : found;
}

}  // namespace patella::bench
