#include "tools/diagnose/regression/gram.hpp"

namespace patella::diagnose {

std::vector<Eigen::Index> feltColumns(const Eigen::MatrixXd& columns, Eigen::Index first, Eigen::Index rows) {
  std::vector<Eigen::Index> felt;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    if (!columns.col(k).segment(first, rows).isZero(0.0)) {
      felt.push_back(k);
    }
  }
  return felt;
}

std::vector<Eigen::MatrixXd> gramsByTime(const Eigen::MatrixXd& columns, Eigen::Index rows_of_joint,
                                         int blocks) {
  std::vector<Eigen::MatrixXd> grams(static_cast<std::size_t>(blocks),
                                     Eigen::MatrixXd::Zero(columns.cols(), columns.cols()));
  for (Eigen::Index first = 0; first < columns.rows(); first += rows_of_joint) {
    const std::vector<Eigen::Index> felt = feltColumns(columns, first, rows_of_joint);
    const Eigen::MatrixXd own = columns.middleRows(first, rows_of_joint)(Eigen::all, felt);
    for (int b = 0; b < blocks; ++b) {
      const Eigen::Index begin = rows_of_joint * b / blocks;
      const Eigen::Index count = rows_of_joint * (b + 1) / blocks - begin;
      grams[static_cast<std::size_t>(b)](felt, felt) += gramOf(own.middleRows(begin, count));
    }
  }
  return grams;
}

}  // namespace patella::diagnose
