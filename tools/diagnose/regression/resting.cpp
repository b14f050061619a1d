#include "tools/diagnose/regression/resting.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

double speed_rad_s(const Series& series, int joint) {
  double square = 0.0;
  for (const model::EffectInput& state : series.states) {
    square += state.dq[joint] * state.dq[joint];
  }
  return std::sqrt(square / static_cast<double>(series.states.size()));
}

std::size_t samples(double duration_s, double rate_Hz) {
  return static_cast<std::size_t>(std::ceil(duration_s * rate_Hz));
}

// States of stretches of `least_s` or more that stay within a range.
void addStays(const Series& series, int joint, double least_s, double within_rad, std::vector<bool>& rests) {
  const std::size_t count = series.states.size();
  const std::size_t least = samples(least_s, series.rate_Hz);
  for (std::size_t first = 0; first + least < count;) {
    double low = series.states[first].q[joint], high = low;
    std::size_t end = first;
    for (; end < count; ++end) {
      const double q = series.states[end].q[joint];
      low = std::min(low, q);
      high = std::max(high, q);
      if (high - low > within_rad) {
        break;
      }
    }
    if (end - first >= least) {
      std::fill(rests.begin() + static_cast<std::ptrdiff_t>(first),
                rests.begin() + static_cast<std::ptrdiff_t>(end), true);
      first = end;
    } else {
      ++first;
    }
  }
}

}  // namespace

std::vector<bool> restingStates(const Series& series, const RestingJoint& of) {
  const int joint = of.joint;
  std::vector<bool> rests(series.states.size(), false);
  const double speed = speed_rad_s(series, joint);
  if (of.pushed) {
    addStays(series, joint, resting::kPushedPause_s, resting::kPushedDrift * speed * resting::kPushedPause_s,
             rests);
  }
  addStays(series, joint, resting::kPause_s, resting::kPauseDrift * speed * resting::kPause_s, rests);
  addStays(series, joint, resting::kTurn_s, resting::kTurnDrift * speed * resting::kTurn_s, rests);
  return rests;
}

std::vector<double> weightsInMotion(const Series& series, std::span<const RestingJoint> joints) {
  const std::size_t count = series.states.size();
  const std::size_t taper = samples(resting::kTaper_s, series.rate_Hz);
  std::vector<std::size_t> away(count, taper);  // states from the next rest, taper at most
  for (const RestingJoint& joint : joints) {
    const std::vector<bool> rests = restingStates(series, joint);
    for (std::size_t i = 0; i < count; ++i) {
      away[i] = rests[i] ? 0 : away[i];
    }
  }
  for (std::size_t i = 1; i < count; ++i) {
    away[i] = std::min(away[i], away[i - 1] + 1);
    away[count - 1 - i] = std::min(away[count - 1 - i], away[count - i] + 1);
  }
  std::vector<double> weights;
  for (const std::size_t states : away) {
    const double share = static_cast<double>(states) / static_cast<double>(taper);
    weights.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * share));
  }
  return weights;
}

std::vector<Eigen::Index> rowsInMotion(std::span<const double> weights, std::span<const Eigen::Index> rows,
                                       double rate_Hz, const RowPlaces& places) {
  std::vector<Eigen::Index> moving;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(moving), [&](Eigen::Index row) {
    return weights[places.first + static_cast<std::size_t>(row) * places.step] >= 0.5;
  });
  const auto shortest = static_cast<std::ptrdiff_t>(samples(resting::kShortestRun_s, rate_Hz) / places.step);
  std::vector<Eigen::Index> kept;
  for (auto run = moving.begin(); run != moving.end();) {
    const auto last = std::adjacent_find(run, moving.end(), [](auto a, auto b) { return b != a + 1; });
    const auto end = last == moving.end() ? last : last + 1;
    if (end - run >= shortest) {
      kept.insert(kept.end(), run, end);
    }
    run = end;
  }
  return kept;
}

}  // namespace patella::diagnose
