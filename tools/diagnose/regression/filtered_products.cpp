#include "tools/diagnose/regression/filtered_products.hpp"

#include <algorithm>
#include <utility>

#include "tools/diagnose/regression/gram.hpp"

namespace patella::diagnose {

FilteredProducts::FilteredProducts(const Weighting& weighting, const Eigen::MatrixXd& columns)
    : staying_(columns.cols()) {
  for (int joint = 0; joint < weighting.joints(); ++joint) {
    filtered_.push_back(std::make_shared<const Eigen::MatrixXd>(weighting.filteredOf(joint, columns)));
  }
  for (Eigen::Index k = 0; k < joints(); ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) {
      stay_.push_back(ofStaying(i, k));
      further_.push_back(ofFurther(i, k));
    }
  }
}

std::size_t FilteredProducts::pair(Eigen::Index i, Eigen::Index k) const noexcept {
  return static_cast<std::size_t>(k * (k + 1) / 2 + i);
}

FilteredProducts::Columns FilteredProducts::feltOf(Eigen::Index joint, Eigen::Index first) const {
  const Eigen::MatrixXd& all = *filtered_[static_cast<std::size_t>(joint)];
  Columns columns{.place = feltColumns(all, 0, all.rows()), .rows = {}};
  std::erase_if(columns.place, [&](Eigen::Index column) { return column < first; });
  columns.rows = all(Eigen::all, columns.place);
  return columns;
}

FilteredProducts::Product FilteredProducts::ofStaying(Eigen::Index i, Eigen::Index k) const {
  const auto staying = [this](Eigen::Index joint) {
    Columns columns = feltOf(joint, 0);
    std::erase_if(columns.place, [this](Eigen::Index column) { return column >= staying_; });
    columns.rows.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(columns.place.size()));
    return columns;
  };
  const Columns left = staying(i);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(staying_, staying_);
  if (i == k) {
    sum(left.place, left.place) = gramOf(left.rows);
  } else {
    const Columns right = staying(k);
    const Eigen::MatrixXd product = left.rows.transpose() * right.rows;
    sum(left.place, right.place) += product;
    sum(right.place, left.place) += product.transpose();
  }
  return std::make_shared<const Eigen::MatrixXd>(std::move(sum));
}

FilteredProducts::Product FilteredProducts::ofFurther(Eigen::Index i, Eigen::Index k) const {
  const Eigen::Index count = filtered_.front()->cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count - staying_);
  const auto add = [&](Eigen::Index one, Eigen::Index other) {
    const Columns left = feltOf(one, 0);
    Columns right = feltOf(other, staying_);
    for (Eigen::Index& place : right.place) {
      place -= staying_;
    }
    sum(left.place, right.place) += left.rows.transpose() * right.rows;
  };
  add(i, k);
  if (i != k) {
    add(k, i);
  }
  return std::make_shared<const Eigen::MatrixXd>(std::move(sum));
}

FilteredProducts FilteredProducts::with(const Weighting& weighting, const Eigen::MatrixXd& further) const {
  FilteredProducts result = *this;
  for (int joint = 0; joint < weighting.joints(); ++joint) {
    const Eigen::MatrixXd& before = *filtered_[static_cast<std::size_t>(joint)];
    Eigen::MatrixXd all(before.rows(), staying_ + further.cols());
    all << before.leftCols(staying_), weighting.filteredOf(joint, further);
    result.filtered_[static_cast<std::size_t>(joint)] =
        std::make_shared<const Eigen::MatrixXd>(std::move(all));
  }
  for (Eigen::Index k = 0; k < joints(); ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) {
      result.further_[pair(i, k)] = result.ofFurther(i, k);
    }
  }
  return result;
}

FilteredProducts FilteredProducts::refiltered(const Weighting& weighting, const Eigen::MatrixXd& columns,
                                              std::span<const int> changed) const {
  const auto isChanged = [&](Eigen::Index joint) {
    return std::find(changed.begin(), changed.end(), joint) != changed.end();
  };
  FilteredProducts result = *this;
  for (const int joint : changed) {
    result.filtered_[static_cast<std::size_t>(joint)] =
        std::make_shared<const Eigen::MatrixXd>(weighting.filteredOf(joint, columns));
  }
  for (Eigen::Index k = 0; k < joints(); ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) {
      if (isChanged(i) || isChanged(k)) {
        result.stay_[pair(i, k)] = result.ofStaying(i, k);
        result.further_[pair(i, k)] = result.ofFurther(i, k);
      }
    }
  }
  return result;
}

Eigen::MatrixXd FilteredProducts::gram(const Eigen::MatrixXd& precision) const {
  const Eigen::Index count = filtered_.front()->cols(), further = count - staying_;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < joints(); ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) {
      sum.topLeftCorner(staying_, staying_) += precision(i, k) * *stay_[pair(i, k)];
      sum.rightCols(further) += precision(i, k) * *further_[pair(i, k)];
    }
  }
  sum.bottomLeftCorner(further, staying_) = sum.topRightCorner(staying_, further).transpose();
  return sum;
}

}  // namespace patella::diagnose
