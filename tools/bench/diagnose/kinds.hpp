// Effects that the simulator knows: those of the library under the library's names, and others that no
// library has. Implemented in plant.cpp, apart from the library's code.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace patella::bench {

enum class Kind {
  kViscous,
  kCoulomb,
  kAsymmetric,
  kStribeck,
  kLoadDependent,
  kPresliding,
  kStiffness,
  kPassiveKnee,
  kPayload,
  kRotor,
  kElasticity,
  kBacklash,
  kRipple,
  kGain,
  kBias,
  kLag,
  kDelay,
  kOffset,
  kTremor,
  kSpasticity,
  kEmg,
  kThermal,
  // Beyond the library.
  kCubicDrag,
  kVaryingInertia,
  kContact,
  kVaryingStiffness,
  kBiarticular,
  kRubbingSpot,
  kHardeningSpring,
  kEmgStiffness,
  // Defects of machines by breaking or wear.
  kLoadTakenUp,
  kRelaxingTissue,
  kDraggingBrake,
  kEccentricBearing,
  kSnaggingCable,
  kWeakeningDrive,
  kDeadZone,
  kDeratingDrive,
};

inline constexpr std::size_t kMaxParameters = 6;

struct KindInfo {
  Kind kind;
  std::string_view name;
  /// Names of the parameters, as in model files; empty ones are not used.
  std::array<std::string_view, kMaxParameters> parameters;
  /// Parameters that grow with the effect's strength, and those that a diagnosis is held to; one bit each.
  unsigned scaled;
  unsigned compared;
  bool in_library;
  /// Variables of its torque, separated by blanks: "q", "dq", "ddq", "tau", "activation" of its joint,
  /// "other_q" the other joint's angle, "time". The first is what betrays it; any of them is a right answer.
  std::string_view variables;
  bool defect = false;  ///< what breaks or wears: the suite of its own that nothing was tuned to
};

std::span<const KindInfo> allKinds() noexcept;
const KindInfo& infoOf(Kind kind) noexcept;
/// nullptr where no effect has this name.
const KindInfo* findKind(std::string_view name) noexcept;

/// An effect that the simulated rig has and the model handed over lacks.
struct TrueEffect {
  Kind kind = Kind::kViscous;
  std::size_t joint = 0;
  std::array<double, kMaxParameters> p{};  ///< in the order of KindInfo::parameters

  const KindInfo& info() const noexcept { return infoOf(kind); }
  std::string label() const { return std::string(info().name) + "@" + std::to_string(joint + 1); }
};

}  // namespace patella::bench
