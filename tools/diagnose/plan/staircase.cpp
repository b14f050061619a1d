#include "tools/diagnose/plan/staircase.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace patella::diagnose {
namespace {

constexpr std::size_t kFewestPlaces = 2, kMostPlaces = 4;
/// One in two places is an end of the range or its middle.
constexpr double kAtEnds = 0.5;
constexpr double kShortestStay = 0.3, kLongestStay = 1.3;
constexpr double kLowestCut = 2.0;

}  // namespace

Staircase Staircase::drawn(double highest_frequency, sim::Random& random) {
  constexpr auto kNumbers = static_cast<double>(kMostPlaces - kFewestPlaces + 1);
  const std::size_t places = kFewestPlaces + static_cast<std::size_t>(random.uniform() * kNumbers);
  Staircase drawn;
  for (std::size_t i = 0; i < places; ++i) {
    const bool at_end = random.uniform() < kAtEnds;
    const double anywhere = 2.0 * random.uniform() - 1.0;
    drawn.place.push_back(at_end ? std::round(anywhere) : anywhere);
    drawn.log_stay.push_back(std::log(kShortestStay + random.uniform() * (kLongestStay - kShortestStay)));
  }
  drawn.log_cut = std::log(kLowestCut + random.uniform() * highest_frequency);
  return drawn;
}

Staircase Staircase::varied(double step, sim::Random& random) const {
  Staircase other = *this;
  for (double& value : other.place) {
    value += step * random.gaussian();
  }
  for (double& value : other.log_stay) {
    value += step * random.gaussian();
  }
  other.log_cut += step * random.gaussian();
  return other;
}

Eigen::VectorXd Staircase::shape(const Eigen::VectorXd& periods) const {
  double whole = 0.0;
  for (const double stay : log_stay) {
    whole += std::exp(stay);
  }
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(2 * periods.size());
  for (Eigen::Index k = 0; k < periods.size(); ++k) {
    const double turn = 2.0 * std::numbers::pi * periods[k];
    double from = 0.0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      const double to = from + turn * std::exp(log_stay[i]) / whole;
      shape[k] += place[i] * (std::cos(from) - std::cos(to)) / turn;
      shape[periods.size() + k] += place[i] * (std::sin(to) - std::sin(from)) / turn;
      from = to;
    }
  }
  const Eigen::ArrayXd kept = (-(periods / std::exp(log_cut)).array().square()).exp();
  shape.head(periods.size()).array() *= kept;
  shape.tail(periods.size()).array() *= kept;
  return shape;
}

}  // namespace patella::diagnose
