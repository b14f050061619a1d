// How large an effect has to be to be told from chance, beside what a fit may take up.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {

/// Detectability of a shape of torque in a recording.
struct Detectable {
  /// Smallest torque that is told from chance in half of all recordings, in units of the joint's noise (rms
  /// of what the fit leaves); infinite where none is.
  double in_noise = 0.0;
  /// rms that the given parameters cannot take up, over the rms of the shape, weighted: 0…1.
  double own_share = 0.0;
  double unit_Nm = 0.0;  ///< rms of the shape as it was given
};

class Detector {
 public:
  /// Takes the given model's parameters for free within their priors; what was found is not among them, or it
  /// would not be seen twice. `threshold`: fall of −2 log-likelihood that chance is held against.
  Detector(const Dataset& data, const ModelFit& fit, double threshold);

  /// Judges the first column, beside the other ones, which come with it.
  Detectable of(const Eigen::Ref<const Eigen::MatrixXd>& columns, int joint) const;
  double threshold() const noexcept { return threshold_; }

 private:
  const Dataset& data_;
  const ModelFit& fit_;
  double threshold_;
  double redundancy_;
  Eigen::MatrixXd explained_;
};

/// Points of an effect's grid that are looked at: some have thousands.
std::vector<const Atom*> someAtoms(std::span<const Atom* const> points);

/// Fall of −2 log-likelihood that the search asked for in its last step.
double thresholdOf(const Diagnosis& diagnosis, const ModelFit& fit);

}  // namespace patella::diagnose
