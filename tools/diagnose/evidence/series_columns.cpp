#include "tools/diagnose/evidence/series_columns.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose::evidence {

Eigen::MatrixXd jointColumns(const Dataset& data, int joint, const std::vector<Sample>& values) {
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(data.rows() * data.joints(), static_cast<Eigen::Index>(values.size()));
  for (std::size_t k = 0; k < values.size(); ++k) {
    columns.col(static_cast<Eigen::Index>(k)).segment(joint * data.rows(), data.rows()) =
        data.variable([&](const Series& series, std::size_t i) {
          return values[k](static_cast<std::size_t>(&series - data.series().data()), i);
        });
  }
  return columns;
}

double velocityRms(const Dataset& data, int joint) {
  constexpr double kLeast_rad_s = 1e-9;
  double sum = 0.0, count = 0.0;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      sum += state.dq[joint] * state.dq[joint];
    }
    count += static_cast<double>(series.states.size());
  }
  return std::max(std::sqrt(sum / count), kLeast_rad_s);
}

}  // namespace patella::diagnose::evidence
