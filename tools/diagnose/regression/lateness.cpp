#include "tools/diagnose/regression/lateness.hpp"

#include <algorithm>
#include <array>

namespace patella::diagnose {

Column torqueRate(const Dataset& data) {
  return data.column([](const Series& series, std::size_t i) -> JointVector {
    const std::size_t last = series.measured_torque_Nm.size() - 1;
    const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, last);
    const double passed_s = static_cast<double>(std::max<std::size_t>(after - before, 1)) / series.rate_Hz;
    return (series.measured_torque_Nm[after] - series.measured_torque_Nm[before]) / passed_s;
  });
}

namespace {

// Central differences of the highest order that a stretch has room for about a row: rows come a few times as
// fast as the band, whose upper end lower orders flatten (Fornberg 1988, Mathematics of Computation 51).
double differenceAt(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index i) {
  constexpr std::array<std::array<double, 4>, 4> kWeights{
      {{1.0 / 2.0, 0.0, 0.0, 0.0},
       {2.0 / 3.0, -1.0 / 12.0, 0.0, 0.0},
       {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0},
       {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0}}};
  const Eigen::Index last = values.size() - 1;
  const Eigen::Index reach = std::min({i, last - i, static_cast<Eigen::Index>(kWeights.size())});
  if (reach == 0) {
    return last == 0 ? 0.0 : (i == 0 ? values[1] - values[0] : values[last] - values[last - 1]);
  }
  double difference = 0.0;
  for (Eigen::Index k = 1; k <= reach; ++k) {
    difference += kWeights[static_cast<std::size_t>(reach - 1)][static_cast<std::size_t>(k - 1)] *
                  (values[i + k] - values[i - k]);
  }
  return difference;
}

}  // namespace

Column rateOf(const Dataset& data, const Column& torque) {
  Column rate(torque.size());
  for (const Block& block : data.blocks()) {
    for (int joint = 0; joint < data.joints(); ++joint) {
      const Eigen::Index first = joint * data.rows() + block.first, count = block.end - block.first;
      for (Eigen::Index i = 0; i < count; ++i) {
        rate[first + i] = data.rate_Hz() * differenceAt(torque.segment(first, count), i);
      }
    }
  }
  return rate;
}

Column besideLateness(const Dataset& data, const Column& error) {
  const Column rate = torqueRate(data);
  Column left = error;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const auto own_rate = rate.segment(joint * data.rows(), data.rows());
    auto own = left.segment(joint * data.rows(), data.rows());
    const double late_s = own_rate.dot(own) / std::max(own_rate.squaredNorm(), 1e-300);
    if (late_s > 0.0) {
      own -= late_s * own_rate;
    }
  }
  return left;
}

}  // namespace patella::diagnose
