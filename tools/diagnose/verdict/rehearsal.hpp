// What the search would make of a torque if a recording held it: its deciding step, rehearsed on what a fit
// leaves. Noise is estimated from what is left, as in the search, so that a torque that is slow or constant
// passes for noise in part here, too.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/regression/noise_model.hpp"

namespace patella::diagnose {

/// What an effect has to overcome.
struct Obstacles {
  double chance = 0.0;               ///< gain less the cost of its parameters that chance brings
  std::vector<double> noise_Nm;      ///< of sensors and declared pushes, joint by joint
  std::vector<double> structure_Nm;  ///< what nothing explains beyond that
  std::vector<double> least_Nm;      ///< torque on each joint below which nothing is missed
};

class Rehearsal {
 public:
  /// `columns` of an effect on `joint`: the first one is its strength, the others come with it. The dataset,
  /// the fit and the obstacles must outlive it.
  Rehearsal(const Dataset& data, const ModelFit& fit, const Obstacles& obstacles, Eigen::MatrixXd columns,
            int joint);

  /// Whether the search would assert the effect in four of five recordings that held so many times the part
  /// of the first column that the others do not give.
  bool asserts(double strength) const;

 private:
  /// Linear fit of the parameters of the given fit, and of the effect.
  ModelFit fitted(const Eigen::VectorXd& torque, const Weighting& weighting, bool with_effect) const;
  bool accepts(const ModelFit& without, const ModelFit& with) const;
  double chanceUnit(const ModelFit& with) const;
  bool outweighsRest(const ModelFit& without, const ModelFit& with) const;

  const Dataset& data_;
  const ModelFit& fit_;
  const Obstacles& obstacles_;
  Eigen::MatrixXd columns_;
  Eigen::VectorXd shape_;
  ModelFit with_;  ///< the effect fitted: nothing of it is in what that leaves
  NoiseProcess noise_;
  double spread_;   ///< standard deviation of the strength
  double against_;  ///< strength that four of five recordings hold against an effect at most
};

}  // namespace patella::diagnose
