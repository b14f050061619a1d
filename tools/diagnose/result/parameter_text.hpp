// Names and numbers of parameters as people read them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

struct ParameterName {
  std::string words;  ///< "smoothing velocity"
  std::string unit;   ///< "rad/s"; empty without one
};

/// Units of a joint's position and torque.
struct Units {
  std::string position = "rad";
  std::string torque = "N·m";
};

/// Of all joints together: "rad or m" where some slide. Parameters of joints that slide bear the names of a
/// rotating joint's.
Units unitsOf(const Diagnosis& diagnosis);
/// Of one joint, from 0.
Units unitsOf(const model::MechanismDescription& mechanism, int joint);
Units unitsOf(const Diagnosis& diagnosis, int joint);

/// Takes the unit off a name of a model file: "smoothing_velocity_rad_s".
ParameterName splitName(std::string_view name, const Units& units = {});

/// "coulomb_friction" as "coulomb friction", "payload@2" as "payload on joint 2".
std::string effectWords(std::string_view label);
std::string effectWords(const EffectFinding& effect);

inline constexpr double kPercent = 100.0;

/// A fitted parameter's name: "coulomb_friction@1 level_Nm" as "coulomb friction on joint 1: level",
/// "mass_kg[2]" as "mass [2]".
std::string parameterWords(std::string_view name, const Units& units = {});

/// As many digits as the interval supports: "1.52 [1.44, 1.60]".
std::string valueWithInterval(double value, const std::array<double, 2>& interval);
/// "level 1.52 [1.44, 1.60] N·m"
std::string estimateText(const ParameterEstimate& estimate, const Units& units = {});
/// ", its torque within 42 %", behind the parameters; empty where these tell how large it is, or it may be
/// none.
std::string torqueErrorText(const EffectFinding& effect);
/// Three significant digits; "–" for what is not a number.
std::string shortNumber(double value);
/// The same of one joint, and "–" where there is none of it.
std::string numberAt(const std::vector<double>& values, std::size_t joint);

/// Where an effect's parameter may lie physically; unlimited where the library does not know it.
std::array<double, 2> physicalRange(std::string_view kind, std::string_view name);

/// "Missing effect found" …
std::string_view verdictWords(Verdict verdict) noexcept;

}  // namespace patella::diagnose
