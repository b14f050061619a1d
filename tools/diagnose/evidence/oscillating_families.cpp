#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/evidence/families.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
/// Lines of each sort that the search looks at.
constexpr std::size_t kLines = 2;
/// Between two points of a periodogram, in cycles over the abscissa.
constexpr double kPointsApart = 0.5;

/// Frequencies from the first, evenly apart.
struct Grid {
  double first = 0.0;
  double step = 1.0;
  std::size_t count = 0;
  double at(std::size_t k) const noexcept { return first + step * static_cast<double>(k); }
};

Grid gridBetween(double first, double last, double range) {
  const double step = kPointsApart / range;
  return {
      .first = first, .step = step, .count = static_cast<std::size_t>(std::max(0.0, (last - first) / step))};
}

// The most prominent frequencies of values over an abscissa.
std::vector<double> lines(const Eigen::VectorXd& values, const Eigen::VectorXd& abscissa, const Grid& grid) {
  constexpr std::size_t kWidth = 4;  // points that belong to one line
  std::vector<double> power(grid.count);
  for (std::size_t k = 0; k < grid.count; ++k) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      sum += values[i] * std::polar(1.0, -kTwoPi * grid.at(k) * abscissa[i]);
    }
    power[k] = std::norm(sum);
  }
  std::vector<std::size_t> order(grid.count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < order.size() && chosen.size() < kLines; ++n) {
    const std::size_t k = order[n];
    if (std::none_of(chosen.begin(), chosen.end(),
                     [=](std::size_t one) { return std::max(one, k) - std::min(one, k) <= kWidth; })) {
      chosen.push_back(k);
    }
  }
  std::vector<double> frequencies;
  for (const std::size_t k : chosen) {
    frequencies.push_back(grid.at(k));
  }
  return frequencies;
}

// amplitude · sin(2π ν x + phase), x a function of the samples.
Family line(const char* kind, const char* name, const Dataset& data, int joint, double frequency,
            const Grid& grid, const Sample& x) {
  return {.kind = kind,
          .joint = joint,
          .nonnegative = {false, false},
          .shape = {{.lower = grid.first - grid.step, .upper = grid.at(grid.count)}},
          .grid = {{frequency}},
          .choices = static_cast<double>(grid.count),
          .columns =
              [&data, joint, x](std::span<const double> nu) {
                const double w = kTwoPi * nu[0];
                return jointColumns(
                    data, joint,
                    {[x, w](std::size_t s, std::size_t i) { return -std::sin(w * x(s, i)); },
                     [x, w](std::size_t s, std::size_t i) { return -std::cos(w * x(s, i)); }});
              },
          .parameters = [kind, name](auto c, auto nu) -> std::vector<double> {
            return Parameters(kind)
                .set("amplitude_Nm", std::hypot(c[0], c[1]))
                .set(name, nu[0])
                .set("phase_rad", std::atan2(c[1], c[0]));
          }};
}

void addTremor(const Dataset& data, int joint, const Eigen::VectorXd& left, std::vector<Family>& all) {
  constexpr double kSlowest_Hz = 3.0;
  constexpr double kFastest_Hz = 12.0;
  constexpr double kBeyondEdge = 1.2;  // of the band: what is left of a line there is as much a line
  const double duration_s = data.time_s().maxCoeff() - data.time_s().minCoeff();
  const Grid grid = gridBetween(kSlowest_Hz, std::min(kFastest_Hz, kBeyondEdge * data.band_Hz()), duration_s);
  const Sample time_s = [&data](std::size_t s, std::size_t i) { return data.series()[s].states[i].time_s; };
  for (const double frequency_Hz : lines(left, data.time_s(), grid)) {
    all.push_back(line("tremor", "frequency_Hz", data, joint, frequency_Hz, grid, time_s));
  }
}

// From one and a half cycles over the range to what the joint's speed keeps within the band.
void addRipple(const Dataset& data, int joint, const Eigen::VectorXd& left, std::vector<Family>& all) {
  constexpr double kCoarsest = 0.5, kFinest = 60.0;  // cycles per radian
  const Eigen::VectorXd position =
      data.variable([joint](const Series& series, std::size_t i) { return series.states[i].q[joint]; });
  const double range = position.maxCoeff() - position.minCoeff();
  const Grid grid = gridBetween(std::max(kCoarsest, 1.5 / range),
                                std::min(kFinest, data.band_Hz() / (1.2 * velocityRms(data, joint))), range);
  const Sample q = [&data, joint](std::size_t s, std::size_t i) {
    return data.series()[s].states[i].q[joint];
  };
  for (const double cycles : lines(left, position, grid)) {
    all.push_back(line("torque_ripple", "cycles_per_rad", data, joint, cycles, grid, q));
  }
}

}  // namespace

std::vector<Family> oscillatingFamilies(const Dataset& data, const Eigen::VectorXd& left) {
  std::vector<Family> all;
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    const Eigen::VectorXd own = left.segment(joint * data.rows(), data.rows());
    addTremor(data, joint, own, all);
    addRipple(data, joint, own, all);
  }
  return all;
}

}  // namespace patella::diagnose::evidence
