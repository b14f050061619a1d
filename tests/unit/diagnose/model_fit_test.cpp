// Limits of a fit of a mechanism.
#include "tools/diagnose/fit/model_fit.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/bounds/bounds.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tests/unit/diagnose/recordings.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("a fit goes no further than a model file may, so that what it finds can be read again") {
  constexpr double kHighest_kg_m2 = boundOf("mechanism.inertia_kg_m2 (revolute)").maximum;
  constexpr double kMoment_kg_m = 1.0;
  const auto fitted_kg_m2 = [&](double true_inertia_kg_m2) {
    Recording recording = swing(20.0);
    for (std::size_t i = 0; i < recording.time_s.size(); ++i) {
      const double q = recording.position_rad[0][i];
      const double ddq = -std::numbers::pi * std::numbers::pi * q;
      recording.torque_Nm[0][i] = true_inertia_kg_m2 * ddq + kMoment_kg_m * 9.81 * std::cos(q);
    }
    const Dataset data(std::array{recording}, DatasetOptions{});
    const model::ModelDescription nominal{
        .mechanism =
            model::RevoluteJointParameters{
                .inertia_kg_m2 = 0.9 * kHighest_kg_m2, .moment_kg_m = kMoment_kg_m, .length_m = 0.4},
        .effects = {}};
    ModelFitter fitter(data, nominal, FitOptions{});
    const model::ModelDescription found = fitter.describe(fitter.nominal());
    CHECK_NOTHROW(app::parseModel(app::modelText(found), "model.extended.toml"));
    return std::get<model::RevoluteJointParameters>(found.mechanism).inertia_kg_m2;
  };
  CHECK(fitted_kg_m2(0.95 * kHighest_kg_m2) == doctest::Approx(0.95 * kHighest_kg_m2).epsilon(0.01));
  CHECK(fitted_kg_m2(1.5 * kHighest_kg_m2) == doctest::Approx(kHighest_kg_m2).epsilon(1e-3));
}
