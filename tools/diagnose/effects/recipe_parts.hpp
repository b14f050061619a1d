// Parts of recipes; and the recipes, by where their effects are: in rubbing surfaces, in the machine,
// in the patient. Each scales where it looks to how the joint moved.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {

using Numbers = std::span<const double>;

/// How a joint moved, which scales where the search looks.
struct Motion {
  int joint = 0;
  double velocity_rms = 0.0;
  double lowest_position = 0.0;
  double position_range = 0.0;
  double torque_rms = 0.0;
  double duration_s = 0.0;
  double band_Hz = 0.0;
  double inertia = 0.0;          ///< mean of the joint's own, kg·m²
  double smoothing_rad_s = 0.0;  ///< of its dry friction
};

/// A kind's parameters by name; what is not set has its descriptor's initial value.
class Parameters {
 public:
  explicit Parameters(std::string_view kind);
  /// Clamped to its range. Throws std::logic_error where the kind has no such parameter.
  Parameters& set(std::string_view name, double value);
  const model::EffectParameter& of(std::string_view name) const;
  operator std::vector<double>() const { return values_; }

 private:
  std::size_t indexOf(std::string_view name) const;

  const model::EffectDescriptor* descriptor_;
  std::vector<double> values_;
};

inline constexpr const char* kSmoothing = "smoothing_velocity_rad_s";

/// All combinations of one value of each axis.
std::vector<std::vector<double>> product(const std::vector<std::vector<double>>& axes);
/// From, from + step … not beyond to.
std::vector<double> range(double from, double to, double step);

/// A recipe of this kind on the motion's joint, with one point of the grid.
Recipe start(const char* kind, const Motion& motion, std::vector<bool> nonnegative);
/// One strength and nothing else.
Recipe single(const char* kind, const Motion& motion, const char* strength, bool nonnegative,
              double smoothing = 0.0);
/// Amplitude and phase as the amplitudes of sine and cosine.
Recipe oscillation(const char* kind, const Motion& motion, const char* frequency,
                   std::vector<double> frequencies);

/// With the basis that follows from its parameters where it has none of its own.
std::shared_ptr<const Recipe> finished(Recipe recipe);

/// Homes of the effects, by where they are.
std::vector<EffectHome> frictionEffects();
std::vector<EffectHome> machineEffects();
std::vector<EffectHome> patientEffects();

}  // namespace patella::diagnose
