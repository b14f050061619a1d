// The one score by which models are compared: how likely the recordings are under a model, with the noise's
// levels and the size of what the model does not know estimated from the same data (type-II maximum
// likelihood: MacKay, Neural Computation 4, 1992; Bishop, Pattern Recognition and Machine Learning, 3.5).
//
//   target = parameters' columns · c + other functions · w + noise,   c ~ N(0, sd²),  w ~ N(0, scale ·
//   spread), noise ~ N(0, level) in each coefficient of a joint's band.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/evidence/moments.hpp"
#include "tools/diagnose/evidence/other.hpp"

namespace patella::diagnose::evidence {

/// A parameter that enters linearly, as a column of the moments: normal about zero beforehand.
struct Parameter {
  Eigen::Index column = 0;
  double sd = 1.0;
};

/// What is estimated beside the parameters.
struct Levels {
  std::vector<Eigen::VectorXd> noise;  ///< of each joint: variance of a coefficient, band by band
  std::vector<double> other;           ///< of each group of other functions: scale of its variance
};

struct Posterior {
  double score = 0.0;  ///< logarithm of the evidence, but for a constant of the recordings
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  Levels levels;
  std::vector<Eigen::VectorXd> weights;  ///< w, by group
};

class Evidence {
 public:
  /// All but `floor` have to outlive it. `other_first`: index of the other functions' first column among the
  /// moments'; `floor`: variance of a coefficient below which no noise is, joint by joint and band by band.
  Evidence(const Moments& moments, const Other& other, Eigen::Index other_first,
           std::vector<Eigen::VectorXd> floor);

  /// Share of each joint's coefficients that count as independent: its likelihood is taken to that power, as
  /// of a sample that comes from near the model and not from it (Miller and Dunson, Journal of the American
  /// Statistical Association 114, 2019). 1 until then.
  void countAsIndependent(std::vector<double> shares) { shares_ = std::move(shares); }

  /// `target`: column that the parameters are to explain. The best of `rounds` + 1 estimates of the levels,
  /// each from the one before.
  Posterior of(std::span<const Parameter> parameters, Eigen::Index target, const Levels& start,
               int rounds) const;
  /// Levels to start from: half of the target is noise, and other functions have this share of its power
  /// each.
  Levels usual(Eigen::Index target, double other_share) const;

  /// What columns would add to the parameters under given levels: information on their coefficients, and its
  /// product with their estimates.
  struct Projected {
    Eigen::MatrixXd information;
    Eigen::VectorXd product;
  };
  Projected beside(std::span<const Parameter> parameters, Eigen::Index target, const Levels& levels,
                   std::span<const Eigen::Index> columns) const;

 private:
  struct Joint;
  struct Solution;
  std::vector<Joint> gather(std::span<const Parameter> parameters, Eigen::Index target) const;
  Solution solve(const std::vector<Joint>& joints, std::span<const Parameter> parameters,
                 const Levels& levels) const;
  Levels reestimated(const std::vector<Joint>& joints, const Solution& solution, const Levels& levels) const;
  void reestimateNoise(const Joint& joint, const Solution& solution, std::size_t j,
                       Eigen::VectorXd& noise) const;
  double coefficients(std::size_t joint, int band) const {
    return shares_[joint] * moments_->coefficients(band);
  }
  /// Prior precision of a joint's other functions.
  Eigen::VectorXd precision(std::size_t joint, const Levels& levels) const;

  const Moments* moments_;
  const Other* other_;
  Eigen::Index other_first_;
  std::vector<Eigen::VectorXd> floor_;
  std::vector<double> shares_;
  std::vector<std::vector<std::size_t>> groups_;  ///< of each joint
  std::vector<Eigen::Index> first_, count_;       ///< of each joint's other functions
};

}  // namespace patella::diagnose::evidence
