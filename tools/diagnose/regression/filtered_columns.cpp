#include "tools/diagnose/regression/filtered_columns.hpp"

#include <algorithm>
#include <utility>

#include "tools/diagnose/regression/gram.hpp"

namespace patella::diagnose {

FilteredColumns::FilteredColumns(const Dataset& data, const Weighting& filters,
                                 const Eigen::MatrixXd& columns)
    : data_(&data),
      filters_(filters),
      count_(columns.cols()),
      of_(static_cast<std::size_t>(data.joints())),
      products_(static_cast<std::size_t>(data.joints() * data.joints())) {
  for (int joint = 0; joint < joints(); ++joint) {
    filter(joint, columns);
  }
  for (int joint = 0; joint < joints(); ++joint) {
    multiply(joint);
  }
}

FilteredColumns FilteredColumns::changed(const Weighting& filters, const Eigen::MatrixXd& columns,
                                         std::span<const int> changed_joints) const {
  FilteredColumns result = *this;
  result.filters_ = filters;
  result.count_ = columns.cols();
  for (const int joint : changed_joints) {
    result.filter(joint, columns);
  }
  for (const int joint : changed_joints) {
    result.multiply(joint);
  }
  return result;
}

void FilteredColumns::filter(int joint, const Eigen::MatrixXd& columns) {
  const Eigen::Index rows = data_->rows();
  OfJoint of{.felt = feltColumns(columns, joint * rows, rows), .rows = {}};
  of.rows = filters_.filtered(joint, columns.middleRows(joint * rows, rows)(Eigen::all, of.felt).eval());
  of_[static_cast<std::size_t>(joint)] = std::make_shared<const OfJoint>(std::move(of));
}

// Products of a joint with all joints.
void FilteredColumns::multiply(int joint) {
  const Eigen::MatrixXd& own = of_[static_cast<std::size_t>(joint)]->rows;
  for (int other = 0; other < joints(); ++other) {
    const Eigen::MatrixXd& its = of_[static_cast<std::size_t>(other)]->rows;
    if (other == joint) {
      productOf(joint, joint) = std::make_shared<const Eigen::MatrixXd>(gramOf(own));
    } else if (other > joint) {
      productOf(joint, other) = std::make_shared<const Eigen::MatrixXd>(own.transpose() * its);
    } else {
      productOf(other, joint) = std::make_shared<const Eigen::MatrixXd>(its.transpose() * own);
    }
  }
}

Eigen::MatrixXd FilteredColumns::gram(const Weighting& scaled) const {
  const Eigen::MatrixXd precision = scaled.precision();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count_, count_);
  for (int joint = 0; joint < joints(); ++joint) {
    for (int other = joint; other < joints(); ++other) {
      const auto& rows = of_[static_cast<std::size_t>(joint)]->felt;
      const auto& columns = of_[static_cast<std::size_t>(other)]->felt;
      const Eigen::MatrixXd part = precision(joint, other) * *productOf(joint, other);
      sum(rows, columns) += part;
      if (other > joint) {
        sum(columns, rows) += part.transpose();
      }
    }
  }
  return sum;
}

Eigen::VectorXd FilteredColumns::products(const Weighting& scaled, const Eigen::VectorXd& column) const {
  const Eigen::MatrixXd filtered = scaled.filtered(column);
  const Eigen::Map<const Eigen::MatrixXd> by_joint(filtered.data(), scaled.rows(), joints());
  const Eigen::MatrixXd dual = by_joint * scaled.precision();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count_);
  for (int joint = 0; joint < joints(); ++joint) {
    const OfJoint& of = *of_[static_cast<std::size_t>(joint)];
    sum(of.felt) += of.rows.transpose() * dual.col(joint);
  }
  return sum;
}

}  // namespace patella::diagnose
