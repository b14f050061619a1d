#include "core/estimation/state_smoother.hpp"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "core/estimation/kalman_observer.hpp"

namespace patella::estimation {
namespace {

struct Filtered {
  KalmanVector state;
  KalmanMatrix covariance;
  KalmanTransition transition;  ///< to this sample
  KalmanVector predicted_state;
  KalmanMatrix predicted_covariance;
};

/// G (later) with G = P Fᵀ (P⁻)⁻¹, in units of each state's own deviation: variances of angles and of forces
/// lie many powers of ten apart.
KalmanVector carriedBack(const KalmanMatrix& covariance, const Filtered& next, const KalmanVector& later) {
  const KalmanVector scale = next.predicted_covariance.diagonal().cwiseSqrt().cwiseInverse();
  const KalmanMatrix scaled = scale.asDiagonal() * next.predicted_covariance * scale.asDiagonal();
  const KalmanVector weights = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(later)));
  KalmanMatrix cross = covariance;
  next.transition.apply(cross);
  return cross.transpose() * weights;
}

}  // namespace

std::vector<UnknownDynamics> smoothUnknownDynamics(const KalmanSettings& settings,
                                                   std::span<const ObserverInput> samples) {
  if (!checked(settings).estimate_position) {
    throw std::invalid_argument("estimate_position is false, expected true for a smoother");
  }
  if (std::any_of(samples.begin(), samples.end(),
                  [](const auto& sample) { return sample.model == nullptr; })) {
    throw std::invalid_argument("a sample to be smoothed has no model, expected one");
  }
  if (samples.empty()) {
    return {};
  }
  KalmanObserver filter(settings, static_cast<int>(samples.front().q.size()));
  filter.reset(samples.front());
  std::vector<Filtered> past;
  past.reserve(samples.size());
  past.push_back({filter.state(), filter.covariance(), {}, {}, {}});
  for (const ObserverInput& sample : samples.subspan(1)) {
    filter.update(sample);
    past.push_back({filter.state(), filter.covariance(), filter.transition(), filter.predictedState(),
                    filter.predictedCovariance()});
  }

  std::vector<UnknownDynamics> result(samples.size());
  KalmanVector smoothed = past.back().state;
  for (std::size_t k = samples.size(); k-- > 0;) {
    if (k + 1 < samples.size()) {
      const KalmanVector later = smoothed - past[k + 1].predicted_state;
      smoothed = past[k].state + carriedBack(past[k].covariance, past[k + 1], later);
    }
    result[k].f_u = filter.unknownDynamics(smoothed, samples[k]);
    result[k].d_Nm = samples[k].terms.inertia * result[k].f_u;
  }
  return result;
}

}  // namespace patella::estimation
