// How far a joint's feedback is from swinging by itself: its phase margin, from gains, inertia and lateness.
//
//   The loop is opened at the drive's command u. s = jω; I is the leg's inertia, N the model's; the drive is
//   late by h; e lies between sample and command, its hold included:
//
//     P = e^(−s(h + e)) / (I s²)                                 from command to position
//     L = K_p [P (1 + h s V) + W₂/N] + K_d [P s V + W₁/N]        impedance at the state ahead
//         + (g_comp N + K_d h + K_p h²/2) Q (1/I − 1/N) I s² P   what the observer sees of a wrong inertia
//     W₁ = (1 − e^(−sh))/s                                       torque under way (drive_anticipation.hpp)
//     W₂ = (1 − (1 + sh) e^(−sh))/s²
//
//   V is the low-pass of a velocity derived from position, Q that of the estimate. The observer itself is
//   taken as fast; other joints are free or held, as the inertia given says.
//
//   Source: Åström and Murray, Feedback Systems, Section 9.3.
#pragma once

namespace patella::control {

/// Feedback of one joint.
struct JointLoop {
  double stiffness_Nm_rad = 0.0;
  double damping_Nms_rad = 0.0;
  double compensation = 0.0;        ///< g_comp of the observer's estimate
  double lateness_s = 0.0;          ///< from demand to torque, looked ahead over (drive_anticipation.hpp)
  double period_s = 1e-3;           ///< between two ticks
  double velocity_cutoff_Hz = 0.0;  ///< 0: the encoder gives the velocity
  double estimate_cutoff_Hz = 0.0;  ///< 0: without
};

struct PhaseMargin {
  /// Least of all frequencies at which |L| is 1, infinite where it never is; negative where the loop swings
  /// up.
  double margin_deg;
  double frequency_Hz;   ///< there; 0 where there is none
  double inertia_kg_m2;  ///< of the leg, with it
};

/// Share by which the leg's inertia is taken to be off the model's at most: tables of body segments know a
/// person's mass and height only.
inline constexpr double kInertiaTolerance = 0.3;

/// Least margin that a configuration may have. Common practice is 30° to 60° (Åström and Murray,
/// Section 9.3).
inline constexpr double kLeastMargin_deg = 30.0;

/// With the model's inertia and the leg's own, kg·m².
PhaseMargin phaseMargin(const JointLoop& loop, double model_inertia_kg_m2, double inertia_kg_m2) noexcept;

/// The least margin with the leg's inertia up to kInertiaTolerance off the model's, both ways.
PhaseMargin leastPhaseMargin(const JointLoop& loop, double model_inertia_kg_m2) noexcept;

}  // namespace patella::control
