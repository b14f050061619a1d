#include "tools/diagnose/fit/angle_shift.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace patella::diagnose {
namespace {

constexpr int kHarmonics = 2;
constexpr double kFarthestSlide_m = 0.3;

// Values of the functions whose sum the regressor is.
Eigen::VectorXd functionsOf(double offset, bool slides) {
  Eigen::VectorXd values(slides ? kHarmonics + 1 : 2 * kHarmonics + 1);
  values[0] = 1.0;
  for (int k = 1; k <= kHarmonics; ++k) {
    if (slides) {
      values[k] = values[k - 1] * offset;
    } else {
      values[2 * k - 1] = std::cos(k * offset);
      values[2 * k] = std::sin(k * offset);
    }
  }
  return values;
}

// As many offsets as there are functions: round the circle, or evenly along the slide.
Eigen::VectorXd offsetsTried(bool slides) {
  const int count = static_cast<int>(functionsOf(0.0, slides).size());
  return slides ? Eigen::VectorXd(Eigen::VectorXd::LinSpaced(count, -kFarthestSlide_m, kFarthestSlide_m))
                : Eigen::VectorXd(2.0 * std::numbers::pi / count *
                                  Eigen::VectorXd::LinSpaced(count, 0.0, count - 1.0));
}

}  // namespace

AngleShift::AngleShift(const std::function<Eigen::MatrixXd(const JointVector& offset)>& columns, int joints,
                       int joint, bool slides)
    : slides_(slides) {
  const Eigen::VectorXd offsets = offsetsTried(slides);
  Eigen::MatrixXd functions(offsets.size(), offsets.size());
  for (Eigen::Index i = 0; i < offsets.size(); ++i) {
    JointVector offset = JointVector::Zero(joints);
    offset[joint] = offsets[i];
    functions.col(i) = functionsOf(offsets[i], slides);
    const Eigen::MatrixXd there = columns(offset);
    rows_ = there.rows();
    parts_.resize(there.size(), offsets.size());
    parts_.col(i) = there.reshaped();
  }
  parts_ *= functions.inverse();
}

AngleShift AngleShift::ofRegressor(const Dataset& data, const model::Mechanism& mechanism, int joint,
                                   bool slides) {
  return {[&](const JointVector& offset) { return data.regressor(mechanism, offset); }, data.joints(), joint,
          slides};
}

AngleShift AngleShift::ofTorque(const Dataset& data, const model::Mechanism& mechanism, int joint,
                                bool slides) {
  return {[&](const JointVector& offset) { return data.mechanismTorque(mechanism, offset); }, data.joints(),
          joint, slides};
}

Eigen::MatrixXd AngleShift::at(double offset) const {
  const Eigen::VectorXd change = functionsOf(offset, slides_) - functionsOf(0.0, slides_);
  return (parts_ * change).reshaped(rows_, parts_.rows() / rows_);
}

}  // namespace patella::diagnose
