#include "tools/studies/learning/forecast.hpp"

#include <cmath>
#include <stdexcept>

#include "core/estimation/kalman_observer.hpp"

namespace patella::study {

namespace {

/// Null where the observer is another.
estimation::KalmanObserver* asFilterOfRate(estimation::Observer* observer) {
  auto* filter = dynamic_cast<estimation::KalmanObserver*>(observer);
  return filter != nullptr && filter->layout().rates > 0 ? filter : nullptr;
}

}  // namespace

bool knowsRate(const Tuned& observer, const Condition& condition) {
  return asFilterOfRate(observer.method->make(condition, observer.values).get()) != nullptr;
}

Delivered predictConstantRate(const Recording& recording, const ObservedRun& run, const Tuned& tuned,
                              double horizon_s) {
  const auto made = tuned.method->make(recording.condition, tuned.values);
  estimation::KalmanObserver* filter = asFilterOfRate(made.get());
  if (filter == nullptr) {
    throw std::invalid_argument(tuned.method->name +
                                " has no rate to predict with, expected a Kalman filter "
                                "of constant rate");
  }
  const model::DynamicsModel model = recording.known();
  const auto settling = static_cast<std::size_t>(kSettling_s * kRate_Hz);
  const auto ahead = static_cast<std::size_t>(std::llround(horizon_s * kRate_Hz));
  Delivered trace;
  for (std::size_t k = 0; k + std::max(settling, ahead) < run.observed.inputs.size(); ++k) {
    estimation::ObserverInput input = run.observed.inputs[k];
    input.model = &model;
    if (k == 0) {
      filter->reset(input);
      continue;
    }
    filter->update(input);
    if (k < settling) {
      continue;
    }
    const estimation::KalmanLayout& layout = filter->layout();
    const int n = layout.joints;
    estimation::KalmanVector state = filter->state();
    const JointVector acceleration =
        input.terms.f + input.terms.inverse_inertia * input.torque_Nm + filter->unknownDynamics(state, input);
    state.head(n) += horizon_s * state.segment(n, n) + 0.5 * horizon_s * horizon_s * acceleration;
    state.segment(n, n) += horizon_s * acceleration;
    state.segment(layout.w(), layout.unknowns) += horizon_s * state.segment(layout.rate(), layout.rates);
    const JointVector posture = state.head(n);
    const JointVector d_Nm = model.mechanism().inertia(posture) * filter->unknownDynamics(state, input);
    append(trace, d_Nm, run, static_cast<Eigen::Index>(k + ahead));
  }
  return trace;
}

}  // namespace patella::study
