#include "tools/diagnose/regression/joint_rest.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/sensor_noise.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
double JointRest::structure_Nm() const noexcept {
  return std::sqrt(std::max(left_Nm * left_Nm - noise_Nm * noise_Nm, 0.0));
}

bool JointRest::exceeds(double share) const noexcept {
  return structure_Nm() > share * torque_Nm && structure_Nm() > unknown::kLikeNoise * noise_Nm;
}

std::vector<double> loads_Nm(const Dataset& data, const model::Mechanism& mechanism) {
  return loads_Nm(data, data.driveTorque(), data.regressor(mechanism, JointVector::Zero(data.joints())),
                  mechanism.baseParameters());
}

std::vector<double> loads_Nm(const Dataset& data, const Column& torque, const Eigen::MatrixXd& regressor,
                             const model::BaseParameters& base) {
  std::vector<double> loads;
  for (int joint = 0; joint < data.joints(); ++joint) {
    double load = jointRms(data, torque, joint);
    for (Eigen::Index k = 0; k < base.size(); ++k) {
      load = std::max(load, jointRms(data, regressor.col(k), joint) * std::abs(base[k]));
    }
    loads.push_back(load);
  }
  return loads;
}

std::vector<bool> drivenJoints(const Dataset& data, const model::Mechanism& mechanism) {
  const std::vector<double> loads = loads_Nm(data, mechanism), torque_Nm = jointRms(data, data.driveTorque());
  std::vector<bool> driven;
  for (std::size_t joint = 0; joint < loads.size(); ++joint) {
    driven.push_back(torque_Nm[joint] > motion::kDriven * loads[joint]);
  }
  return driven;
}

bool swingsFreely(const Dataset& data, const Eigen::MatrixXd& regressor, const model::BaseParameters& base) {
  const Column torque = regressor * base;
  double squares = 0.0;
  for (const double term_Nm : loads_Nm(data, Column::Zero(torque.size()), regressor, base)) {
    squares += term_Nm * term_Nm * static_cast<double>(data.rows());
  }
  return torque.squaredNorm() < std::pow(convention::kAsMachines, 2) * squares;
}

std::vector<JointRest> jointRests(const Dataset& data, const model::Mechanism& mechanism, const Column& left,
                                  std::span<const double> noise_Nm) {
  const std::vector<double> loads = loads_Nm(data, mechanism), torque_Nm = jointRms(data, data.driveTorque()),
                            all_left_Nm = jointRms(data, left);
  std::vector<JointRest> rests;
  for (std::size_t joint = 0; joint < loads.size(); ++joint) {
    const bool driven = torque_Nm[joint] > motion::kDriven * loads[joint];
    rests.push_back({.torque_Nm = driven ? torque_Nm[joint] : loads[joint],
                     .left_Nm = all_left_Nm[joint],
                     .noise_Nm = noise_Nm[joint],
                     .driven = driven});
  }
  return rests;
}

std::vector<double> knownNoise_Nm(std::span<const Recording> recordings, const model::Mechanism& mechanism,
                                  double band_Hz, std::span<const double> person_Nm) {
  std::vector<double> noise_Nm = sensorNoise_Nm(recordings, mechanism, band_Hz);
  for (std::size_t j = 0; j < std::min(noise_Nm.size(), person_Nm.size()); ++j) {
    noise_Nm[j] = std::hypot(noise_Nm[j], std::sqrt(unknown::kPush) * person_Nm[j]);
  }
  return noise_Nm;
}

}  // namespace patella::diagnose
