// Whether recordings can be of the machine that a model describes, before anything is fitted: an effect that
// is found in columns that were swapped, or in degrees taken for radians, is worse than none.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware_app/files/model_file.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// How well the nominal model explains a recording whose signals are read in some way.
struct Reading {
  std::string mistake;  ///< "q2_rad is in degrees"; empty for the recording as given
  std::string change;   ///< "q2·π/180": what would put it right
  /// ‖torque − model‖ / ‖torque‖ below 6 Hz, root mean square over the joints; base parameters within ±30 %.
  double error = 0.0;
  /// The same with base parameters within a factor of four, and friction, stiffness and bias on every joint.
  double error_with_effects = 0.0;
};

/// The recording as given, then every mistake that is looked for. Throws std::invalid_argument where no
/// stretch takes 2 s.
std::vector<Reading> readings(const Recording& recording, const app::ModelDescription& model);

/// Throws std::invalid_argument, naming recording, signal, value and expectation: other joints than the
/// model's, values that are not finite, fewer than 200 rows or 2 s (10 postures at rest), a rate too low for
/// the motion, angles beyond ±4π that the model explains no worse as degrees, signals that the model explains
/// far better when they are read in another way, and torques whose size only another unit explains.
void requirePlausible(std::span<const Recording> recordings, const app::ModelDescription& model);

}  // namespace patella::diagnose
