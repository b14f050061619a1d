// What a motion tells of a model's parameters and of effects: the information matrix of the inverse dynamics
// that are linear in both, before anything is measured.
//   τ = Y(q, q̇, q̈) β + Σ_d c_d(q, q̇, q̈) γ_d + Σ_e c_e(q, q̇, q̈) s_e + noise
// β: base parameters; γ: declared effects; s: sizes of the effects that are planned for.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/plan/motion_family.hpp"
#include "tools/diagnose/plan/planned_effects.hpp"
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
};

struct InformationOptions {
  std::vector<NoiseOfJoint> noise;  ///< of each joint
  double nominal_tolerance = runaway::kTolerance;
  bool parameters = true;  ///< the base parameters are asked for, too, and not only in the way
};

class Information {
 public:
  Information(const model::ModelDescription& model, std::vector<PlannedEffect> effects,
              const InformationOptions& options);

  std::span<const PlannedEffect> effects() const noexcept { return effects_; }

  /// Logarithm of the determinant of the information on what is asked for: its Schur complement in the whole
  /// matrix, so that what stands in the way is taken for unknown. Known beforehand are parameters within
  /// their tolerance, and that no effect is beyond its physical range.
  double logDeterminant(const SampledMotion& motion);

  /// The smallest size of each effect that four in five recordings of the motion would reveal, each by
  /// itself beside the nominal parameters (smallestTorque_Nm of verdict/power.hpp).
  std::vector<Revealed> revealed(const SampledMotion& motion);

 private:
  struct Parts;
  Parts partsOf(const SampledMotion& motion);
  Eigen::MatrixXd columnsOf(const SampledMotion& motion);

  model::ModelDescription model_;
  model::DynamicsModel bare_;
  TorqueAlong torque_;
  std::vector<PlannedEffect> effects_;
  InformationOptions options_;
  /// One for each basis term of an effect, planned or declared; made once, since makeEffect allocates.
  struct Source {
    std::unique_ptr<model::Effect> effect;
    double weight = 1.0;
    Eigen::Index column = 0;
  };
  std::vector<Source> sources_;
  Eigen::Index columns_ = 0;              ///< base parameters, declared effects, then those planned for
  std::vector<Eigen::Index> main_;        ///< column of each planned effect's size
  std::vector<Eigen::Index> companions_;  ///< of each planned effect, columns that follow its main one
  Eigen::VectorXd prior_;                 ///< 1 / variance that is known beforehand
};

}  // namespace patella::diagnose
