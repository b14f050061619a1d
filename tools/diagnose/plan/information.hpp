// What a motion tells of a model's parameters and of effects: the information matrix of the inverse dynamics
// that are linear in both, before anything is measured.
//   τ = Y(q, q̇, q̈) β + Σ_d c_d(q, q̇, q̈) γ_d + Σ_e c_e(q, q̇, q̈) s_e + noise
// β: base parameters; γ: declared effects; s: sizes of the effects that are planned for.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/plan/motion_columns.hpp"
#include "tools/diagnose/plan/motion_family.hpp"
#include "tools/diagnose/plan/planned_effects.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

/// A recording's noise is independent so many times a second at most: twice the narrowest band of an analysis
/// (motionBand_Hz).
inline constexpr double kIndependent_Hz = 12.0;
/// A person's push lasts longer: people push and yield about once a second.
inline constexpr double kPushes_Hz = 2.4;

struct NoiseOfJoint {
  double noise_Nm = 0.0;      ///< rms within the analysis' band
  double structure_Nm = 0.0;  ///< what no effect explains beyond it
  bool pushed = false;        ///< by a person, as a part of the noise
};

struct InformationOptions {
  std::vector<NoiseOfJoint> noise;  ///< of each joint
  double nominal_tolerance = runaway::kTolerance;
  bool parameters = true;  ///< the base parameters are asked for, too, and not only in the way
};

class Information {
 public:
  /// A joint whose dry friction is declared or planned for is held by it while it rests, and the way in which
  /// a joint moves that a person pushes there is hers: such instants count nothing, as in a diagnosis
  /// (restingJoints of fit/sticking.hpp).
  Information(const model::ModelDescription& model, std::vector<PlannedEffect> effects,
              const InformationOptions& options);

  std::span<const PlannedEffect> effects() const noexcept { return columns_.effects(); }

  /// Logarithm of the determinant of the information on what is asked for: its Schur complement in the whole
  /// matrix, so that what stands in the way is taken for unknown. Known beforehand are parameters within
  /// their tolerance, and that no effect is beyond its physical range.
  double logDeterminant(const SampledMotion& motion);

  /// The smallest size of each effect that four in five recordings of the motion would reveal, each by
  /// itself beside the nominal parameters (smallestTorque_Nm of verdict/power.hpp), and whose torque anybody
  /// would miss (accepted::kLeastOfLoad).
  std::vector<Revealed> revealed(const SampledMotion& motion);

  /// How many times smaller sizes of the first effect the best motion of this duration within the limits
  /// could reveal, at most. Not a number for an effect that depends on time or on the past, where the motion
  /// tells nothing of it, and where it tells more than anybody would miss.
  double headroom(const SampledMotion& motion, const MotionLimits& limits);

 private:
  struct Parts;
  /// What information alone tells of an effect.
  struct Told {
    double unit_Nm = 0.0;                                        ///< rms of one unit of it on its joint
    double torque_Nm = std::numeric_limits<double>::infinity();  ///< smallest, rms; infinite where none
  };
  Parts partsOf(const SampledMotion& motion);
  Told told(const Parts& parts, const SampledMotion& motion, std::size_t effect) const;
  /// Columns that stand in the way of one effect's size: those of the model, and its companions.
  std::vector<Eigen::Index> beside(std::size_t effect) const;
  /// Information on one effect's size beside those.
  double left(const Eigen::MatrixXd& gram, std::size_t effect) const;

  InformationOptions options_;
  MotionColumns columns_;
  std::vector<RestingJoint> held_at_rest_;
};

}  // namespace patella::diagnose
