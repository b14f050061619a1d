// A body on the last link of a chain that its model lacks: a payload, a tool, an orthosis.
#pragma once

#include <array>
#include <optional>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/fit/point_body.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// The masses of all links could take its place, and mostly have to leave their tolerances for it. Whether it
/// is there is told by a diagnosis of the model that has it.
struct CarriedBody {
  PointBody body;
  double gain_nats = 0.0;  ///< by which the model's parameters are likelier with it
  std::array<double, 2> mass_ci95_kg{};
  std::array<double, 2> distance_ci95_m{};  ///< of its distance from the last link's origin
};

/// One that brings the masses of a single chain back to what its model has, where some left their tolerances.
/// `redundancy`: as in ModelFitter, of the fit behind the diagnosis.
std::optional<CarriedBody> suspectedBody(const Dataset& data, const model::ModelDescription& given,
                                         const FitOptions& options, double redundancy,
                                         const Diagnosis& diagnosis);

/// Whether masses are far nearer to the model's with the body, and as little is left.
bool bodyBearsOut(const Diagnosis& with_body, const Diagnosis& as_given);

/// The answer of a diagnosis that bears the body out: the body is found beside what there is.
/// `before`: without the body.
Diagnosis withBodyFound(const CarriedBody& found, Diagnosis with_body, const Diagnosis& before);

}  // namespace patella::diagnose
