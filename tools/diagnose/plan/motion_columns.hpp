// The columns of the linear inverse dynamics: base parameters of the mechanism, effects that the model
// declares, then the effects that are planned for, each with its companions.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/plan/motion_family.hpp"
#include "tools/diagnose/plan/planned_effects.hpp"

namespace patella::diagnose {

class MotionColumns {
 public:
  /// `tolerance`: relative standard deviation by which base parameters and declared effects may be wrong.
  MotionColumns(const model::ModelDescription& model, std::vector<PlannedEffect> effects, double tolerance);

  std::span<const PlannedEffect> effects() const noexcept { return effects_; }
  Eigen::Index count() const noexcept { return prior_.size(); }
  Eigen::Index baseParameters() const noexcept { return bare_.mechanism().baseParameterCount(); }
  model::BaseParameters nominal() const { return bare_.mechanism().baseParameters(); }
  /// Columns of the model, which come first.
  Eigen::Index ofModel() const noexcept { return main_.empty() ? count() : main_.front(); }
  /// Column of each planned effect's size, and how many companions follow it.
  const std::vector<Eigen::Index>& main() const noexcept { return main_; }
  const std::vector<Eigen::Index>& companions() const noexcept { return companions_; }
  /// 1 / variance of each column's size that is known beforehand.
  const Eigen::VectorXd& prior() const noexcept { return prior_; }
  TorqueAlong& torque() noexcept { return torque_; }

  /// One row for each joint, at the instants of a motion in their order; `step_s` is 0 at the first of them.
  Eigen::MatrixXd at(const JointVector& q, const JointVector& dq, const JointVector& ddq, double time_s,
                     double step_s);
  /// The rows of joint 1, then those of joint 2. Not `in_order`: each state by itself, without past and at
  /// time 0.
  Eigen::MatrixXd along(const SampledMotion& motion, bool in_order = true);

 private:
  model::DynamicsModel bare_;
  TorqueAlong torque_;
  std::vector<PlannedEffect> effects_;
  /// One for each basis term of an effect, planned or declared; made once, since makeEffect allocates.
  struct Source {
    std::unique_ptr<model::Effect> effect;
    double weight = 1.0;
    Eigen::Index column = 0;
  };
  std::vector<Source> sources_;
  std::vector<Eigen::Index> main_, companions_;
  Eigen::VectorXd prior_;
};

}  // namespace patella::diagnose
