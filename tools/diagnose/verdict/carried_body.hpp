// A body on the last link of a chain that its model lacks: a payload, a tool, an orthosis.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Small beside the chain, so that a point has its mass. The masses of all links could take its place, and
/// mostly have to leave their tolerances for it. Whether it is there is told by a diagnosis of the model that
/// has it.
struct CarriedBody {
  double mass_kg = 0.0;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< in the axes of the last link
  double gain_nats = 0.0;                          ///< by which the model's parameters are likelier with it
  std::array<double, 2> mass_ci95_kg{};
  std::array<double, 2> distance_ci95_m{};  ///< of its distance from the last link's origin
};

/// The model of a single chain with the body on its last link; other models stay as they are.
model::ModelDescription withBody(model::ModelDescription model, const CarriedBody& body);

/// One that brings the masses of a single chain back to what its model has, where some left their tolerances.
std::optional<CarriedBody> suspectedBody(const Dataset& data, const model::ModelDescription& given,
                                         const FitOptions& options, const Diagnosis& diagnosis);

/// Whether masses are far nearer to the model's with the body, and as little is left.
bool bodyBearsOut(const Diagnosis& with_body, const Diagnosis& as_given);

/// The answer of a diagnosis that bears the body out: the body is found beside what there is.
/// `before`: without the body.
Diagnosis withBodyFound(const CarriedBody& body, Diagnosis with_body, const Diagnosis& before);

}  // namespace patella::diagnose
