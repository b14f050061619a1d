#include "tools/diagnose/regression/gram.hpp"

#include <vector>

namespace patella::diagnose {

Eigen::MatrixXd gramByJoint(const Eigen::MatrixXd& columns, Eigen::Index rows_of_joint) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  for (Eigen::Index first = 0; first < columns.rows(); first += rows_of_joint) {
    const auto own = columns.middleRows(first, rows_of_joint);
    std::vector<Eigen::Index> felt;
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
      if (!own.col(k).isZero(0.0)) {
        felt.push_back(k);
      }
    }
    gram(felt, felt) += gramOf(own(Eigen::all, felt).eval());
  }
  return gram;
}

}  // namespace patella::diagnose
