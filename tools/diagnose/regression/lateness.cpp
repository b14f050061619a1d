#include "tools/diagnose/regression/lateness.hpp"

#include <algorithm>

namespace patella::diagnose {

Column torqueRate(const Dataset& data) {
  return data.column([](const Series& series, std::size_t i) -> JointVector {
    const std::size_t last = series.measured_torque_Nm.size() - 1;
    const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, last);
    const double passed_s = static_cast<double>(std::max<std::size_t>(after - before, 1)) / series.rate_Hz;
    return (series.measured_torque_Nm[after] - series.measured_torque_Nm[before]) / passed_s;
  });
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
