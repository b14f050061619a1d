// Settings of a Kalman filter of the unknown dynamics: its noise, and the disturbance that it looks for.
#pragma once

#include <cstdint>

#include "core/types.hpp"

namespace patella::estimation {

struct KalmanSettings {
  /// The quantity w that the filter estimates, and how it moves the leg.
  enum class Space : std::uint8_t {
    kJointTorque,   ///< w in N·m:  f_u = I⁻¹ w
    kAcceleration,  ///< w in rad/s²:  f_u = w
    kForce,         ///< w in N, at the end point:  f_u = I⁻¹ Jᵀ w; with one joint only a part is visible
    kForceAsPrinted,  ///< the paper's (36), (37), with two joints:  f_u = J w
  };
  /// How w moves when nothing is measured.
  enum class Disturbance : std::uint8_t {
    kRandomWalk,    ///< dw is white
    kConstantRate,  ///< ddw is white
  };

  Space space = Space::kJointTorque;
  Disturbance disturbance = Disturbance::kConstantRate;
  /// True: position is measured with noise, and the known terms are evaluated at the estimated state. False:
  /// position counts as known and only velocity is filtered, which takes a measured velocity.
  bool estimate_position = true;

  double position_noise_rad = 1e-4;    ///< standard deviation; of a quantiser, its step / √12
  double velocity_noise_rad_s = 1e-2;  ///< likewise; not looked at where velocity is not measured
  double torque_noise_Nm = 1e-2;       ///< of the torque held over one step
  /// Density of the white drive of each component of w: N·m (N, rad/s²) per √s, and per s^{3/2} for a
  /// constant rate. A force has two components, whatever the number of joints.
  PerJoint disturbance_density = everyJoint(5.0);
  /// Standard deviation beyond which w counts as nought rather than as unknown: where a posture hides a part
  /// of w, as the straight knee hides the force along the leg, that part drifts no further. The rate of w is
  /// bounded by ten times this a second; at the start both are unknown by half their bounds.
  double disturbance_limit = 50.0;
  /// Spaces of force: density, N·m/√s, of a joint torque that no force at the end point explains, as when the
  /// patient pushes elsewhere and the knee is straight. 0: there is none.
  double rest_density_Nm = 0.0;
};

/// Returns the settings. Throws std::invalid_argument naming setting, value and bounds
/// (core/bounds/run_configuration.hpp).
const KalmanSettings& checked(const KalmanSettings& settings);

}  // namespace patella::estimation
