#include "tools/studies/learning/adaptation.hpp"

#include <cmath>
#include <numbers>

#include "core/model/presets.hpp"

namespace patella::study {

BodyDirections directionsOf(AdaptedBody body) {
  const model::PlanarTwoLinkParameters nominal = model::physicalLeg().parameters;
  if (body == AdaptedBody::kWhole) {
    return model::PlanarTwoLink(nominal).baseParameters().asDiagonal().toDenseMatrix();
  }
  model::PlanarTwoLinkParameters heavier = nominal;
  heavier.mass_kg[1] *= 2.0;
  heavier.inertia_kg_m2[1] *= 2.0;
  return model::PlanarTwoLink(heavier).baseParameters() - model::PlanarTwoLink(nominal).baseParameters();
}

AdaptiveFilter makeAdaptiveFilter(AdaptedBody body, std::span<const double> values) {
  AdaptiveSettings settings{.body = directionsOf(body)};
  settings.position_noise_rad = 2.0 * std::numbers::pi / std::exp2(kEncoderBits) / std::sqrt(12.0);
  settings.torque_noise_Nm = kTorqueNoise_Nm;
  settings.push_density = {values[0], values[1]};
  settings.push_corner_Hz = values[2];
  return AdaptiveFilter(settings);
}

Method adaptiveMethod(AdaptedBody body) {
  Method method;
  method.name = body == AdaptedBody::kShank ? "adaptive, shank and friction"
                                            : "adaptive, five base parameters and friction";
  method.tunables = {{"push_density", 10.0}, {"push_density", 10.0}, {"push_corner_Hz", 0.3}};
  method.needs_velocity = false;
  method.make = [body](const Condition&,
                       std::span<const double> values) -> std::unique_ptr<estimation::Observer> {
    return std::make_unique<AdaptiveFilter>(makeAdaptiveFilter(body, values));
  };
  return method;
}

Delivered deliverAdaptive(AdaptiveFilter& filter, const Recording& recording, const ObservedRun& run,
                          bool keep, double horizon_s) {
  const model::DynamicsModel model = recording.known();
  const auto settling = static_cast<std::size_t>(kSettling_s * kRate_Hz);
  const auto ahead = static_cast<std::size_t>(std::llround(horizon_s * kRate_Hz));
  Delivered trace;
  for (std::size_t k = 0; k + std::max(settling, ahead) < run.observed.inputs.size(); ++k) {
    estimation::ObserverInput input = run.observed.inputs[k];
    input.model = &model;
    if (k == 0) {
      keep ? filter.restart(input) : filter.reset(input);
      continue;
    }
    filter.update(input);
    if (k < settling) {
      continue;
    }
    const JointVector estimate = filter.push_Nm(input, horizon_s);
    append(trace, estimate, run, static_cast<Eigen::Index>(k + ahead));
  }
  return trace;
}

}  // namespace patella::study
