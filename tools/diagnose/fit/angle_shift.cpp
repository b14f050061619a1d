#include "tools/diagnose/fit/angle_shift.hpp"

#include <cmath>
#include <numbers>

namespace patella::diagnose {
namespace {

constexpr int kNodes = 8;

}  // namespace

AngleShift::AngleShift(const Dataset& data, const model::Mechanism& mechanism, int joint) {
  JointVector offset_rad = JointVector::Zero(data.joints());
  const Eigen::MatrixXd unshifted = data.regressor(mechanism, offset_rad);
  for (int node = 0; node < kNodes; ++node) {
    const double turn = (node + 0.5) * std::numbers::pi / kNodes;
    angles_rad_.push_back(kFarthest_rad * std::cos(turn));
    weights_.push_back((node % 2 == 0 ? 1.0 : -1.0) * std::sin(turn));
    offset_rad[joint] = angles_rad_.back();
    shifts_.emplace_back(data.regressor(mechanism, offset_rad) - unshifted);
  }
}

Eigen::MatrixXd AngleShift::at(double angle_rad) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(shifts_.front().rows(), shifts_.front().cols());
  double total = 0.0;
  for (std::size_t node = 0; node < shifts_.size(); ++node) {
    const double apart_rad = angle_rad - angles_rad_[node];
    if (apart_rad == 0.0) {
      return shifts_[node];
    }
    const double share = weights_[node] / apart_rad;
    sum += share * shifts_[node];
    total += share;
  }
  return sum / total;
}

}  // namespace patella::diagnose
