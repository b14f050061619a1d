// Products of columns with each other.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace patella::diagnose {

/// columnsᵀ·columns, whose one half is worked out and the other copied.
template <typename Columns>
Eigen::MatrixXd gramOf(const Eigen::MatrixBase<Columns>& columns) {
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  half.selfadjointView<Eigen::Lower>().rankUpdate(columns.derived().transpose());
  return half.selfadjointView<Eigen::Lower>();
}

/// Which columns are not zero on so many rows from the first. Most parameters of a chain's links are felt by
/// the joints before them only.
std::vector<Eigen::Index> feltColumns(const Eigen::MatrixXd& columns, Eigen::Index first, Eigen::Index rows);

/// columnsᵀ·columns of columns of several joints, so many rows each, block by block of time: of so many parts
/// of each joint's rows. Most parameters of a chain's links are felt by the joints before them only.
std::vector<Eigen::MatrixXd> gramsByTime(const Eigen::MatrixXd& columns, Eigen::Index rows_of_joint,
                                         int blocks);

}  // namespace patella::diagnose
