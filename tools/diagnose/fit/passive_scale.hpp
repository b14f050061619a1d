// What is left on a joint without a drive, measured by the masses that swing there.
#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Nothing asks a joint that is not driven for N·m: masses, moments and inertias larger by one factor move it
/// alike, and smaller ones leave less of a torque there, whatever is wrong with the motion. Its torques count
/// in the load of the masses, rms, in units of that of the nominal ones.
class PassiveScale {
 public:
  /// Of no joint.
  PassiveScale() = default;
  /// Of the joints that `driven` leaves, where it has any. `regressor` and `base`: of the nominal mechanism.
  PassiveScale(const Dataset& data, const Eigen::MatrixXd& regressor, const Eigen::VectorXd& base,
               const std::vector<bool>& driven);

  /// It changes nothing.
  bool isEmpty() const noexcept { return joints_.empty(); }
  /// Multiplies each such joint's rows of Columns by the nominal load over that of the base parameters.
  void apply(const Eigen::VectorXd& base, Eigen::MatrixXd& columns) const;
  /// Adds what the factor itself does to the derivatives by base parameters `slopes` · z: `torque` is a
  /// Column of what was multiplied.
  void addSlopes(const Eigen::VectorXd& base, const Eigen::MatrixXd& slopes, const Eigen::VectorXd& torque,
                 Eigen::Ref<Eigen::MatrixXd> tangent) const;

 private:
  struct Joint {
    Eigen::VectorXd squares;  ///< of the joint's part of each column of the regressor
    double nominal = 0.0;     ///< square of the load
  };
  static double squareOf(const Joint& joint, const Eigen::VectorXd& base);
  static double factor(const Joint& joint, const Eigen::VectorXd& base);

  Eigen::Index rows_ = 0;
  std::map<int, Joint> joints_;
};

}  // namespace patella::diagnose
