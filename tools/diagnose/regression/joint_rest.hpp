// A joint's residual torque, against its torque and against the noise of sensors.
#pragma once

#include <span>
#include <vector>

#include "core/model/mechanism.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// rms values below the band's edge, N·m (N on a rail).
struct JointRest {
  double torque_Nm = 0.0;  ///< of the drive; of the load that the model has, where the joint is not driven
  double left_Nm = 0.0;    ///< what the model leaves with everything that was found
  double noise_Nm = 0.0;   ///< what sensors and declared pushes make
  bool driven = true;      ///< its torque is more than a sensor's zero beside the load
  double structure_Nm() const noexcept;  ///< what is left beyond noise
  /// More than this share of the torque is left beyond noise, and more than may be called noise
  /// (unknown::kLikeNoise).
  bool exceeds(double share) const noexcept;
};

/// rms of the largest of each joint's drive torque and its rigid-body terms, N·m; a term may be large where
/// the torque is small, as gravity is beside an inertia that swings.
std::vector<double> loads_Nm(const Dataset& data, const model::Mechanism& mechanism);
/// The same, where the mechanism's regressor is known already. `torque`: of the drives.
std::vector<double> loads_Nm(const Dataset& data, const Column& torque, const Eigen::MatrixXd& regressor,
                             const model::BaseParameters& base);

/// Whether gravity and inertia balance each other, up to what machines leave of their models. What the
/// balance is off by is then the model's error, which grows with the masses, and not a torque that tells
/// them. `regressor` and `base`: of the nominal mechanism.
bool swingsFreely(const Dataset& data, const Eigen::MatrixXd& regressor, const model::BaseParameters& base);

/// Joint by joint: whether its torque is more than a sensor's zero beside the load.
std::vector<bool> drivenJoints(const Dataset& data, const model::Mechanism& mechanism);

/// `left`: residual of the drives' torque; `noise_Nm`: of each joint.
std::vector<JointRest> jointRests(const Dataset& data, const model::Mechanism& mechanism, const Column& left,
                                  std::span<const double> noise_Nm);

/// Noise of each joint's torque by sensors and by declared pushes of these rms values, N·m.
/// `person_Nm`: one for each joint, or empty.
std::vector<double> knownNoise_Nm(std::span<const Recording> recordings, const model::Mechanism& mechanism,
                                  double band_Hz, std::span<const double> person_Nm);

}  // namespace patella::diagnose
