#include "tools/diagnose/fit/passive_scale.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose {

PassiveScale::PassiveScale(const Dataset& data, const Eigen::MatrixXd& regressor, const Eigen::VectorXd& base,
                           const std::vector<bool>& driven)
    : rows_(data.rows()) {
  if (std::find(driven.begin(), driven.end(), true) == driven.end()) {
    return;
  }
  for (std::size_t j = 0; j < driven.size(); ++j) {
    const auto first = static_cast<Eigen::Index>(j) * rows_;
    Joint joint{.squares = regressor.middleRows(first, rows_).colwise().squaredNorm().transpose()};
    joint.nominal = joint.squares.dot(base.cwiseAbs2());
    if (!driven[j] && joint.nominal > 0.0) {
      joints_.emplace(static_cast<int>(j), std::move(joint));
    }
  }
}

// Of the load; never zero.
double PassiveScale::squareOf(const Joint& joint, const Eigen::VectorXd& base) {
  return std::max(joint.squares.dot(base.cwiseAbs2()), 1e-12 * joint.nominal);
}

double PassiveScale::factor(const Joint& joint, const Eigen::VectorXd& base) {
  return std::sqrt(joint.nominal / squareOf(joint, base));
}

void PassiveScale::apply(const Eigen::VectorXd& base, Eigen::MatrixXd& columns) const {
  for (const auto& [index, joint] : joints_) {
    columns.middleRows(index * rows_, rows_) *= factor(joint, base);
  }
}

void PassiveScale::addSlopes(const Eigen::VectorXd& base, const Eigen::MatrixXd& slopes,
                             const Eigen::VectorXd& torque, Eigen::Ref<Eigen::MatrixXd> tangent) const {
  for (const auto& [index, joint] : joints_) {
    // The logarithm of the factor is that of the load, with the other sign.
    const Eigen::VectorXd of_load = joint.squares.cwiseProduct(base) / squareOf(joint, base);
    tangent.middleRows(index * rows_, rows_).noalias() -=
        factor(joint, base) * torque.segment(index * rows_, rows_) * (of_load.transpose() * slopes);
  }
}

}  // namespace patella::diagnose
