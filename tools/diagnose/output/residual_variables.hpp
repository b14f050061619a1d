// Variables against which a residual is drawn.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Times of the rows with recordings one after the other, and where they break.
struct Layout {
  std::vector<double> time_s;
  std::vector<Segment> stretches;
};

Layout layoutOf(const JointCurves& curves, double rate_Hz);

/// Postures, which have no order in time.
bool isAtRest(const Diagnosis& diagnosis);

struct Variable {
  using Kind = Shows;
  Kind kind = Kind::kVelocity;
  int index = 0;  ///< joint or EMG channel
  auto operator<=>(const Variable&) const = default;
};

/// In which variable an effect shows.
Variable betrayedBy(const Diagnosis& diagnosis, const EffectFinding& finding);

/// The first factor of a dependence's variable: "ddq1*q2" is drawn against ddq1. Nothing for other names.
std::optional<Variable> variableNamed(std::string_view name);

struct NamedValues {
  std::string label;
  std::vector<double>
      values;  ///< one for each row of the curves; empty where the diagnosis does not have them
};

NamedValues valuesOf(const Diagnosis& diagnosis, const Variable& variable, const Layout& layout);

/// Torque on the effect's joint that the extended model needs because of this effect, at each row: what would
/// be left over without it. Computed from the curves, so that it is blind to what lies outside their band.
/// Empty where the extended model does not hold the effect.
std::vector<double> shareOf(const Diagnosis& diagnosis, const EffectFinding& finding, const Layout& layout);

}  // namespace patella::diagnose
