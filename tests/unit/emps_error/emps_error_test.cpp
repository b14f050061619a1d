// The benchmark's error, against the figure that is published for the published model.
#include "tools/studies/measured/emps_error.hpp"

#include <filesystem>
#include <stdexcept>

#include <doctest/doctest.h>

#include "firmware_app/files/model_file.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella;

namespace {

const std::filesystem::path kTools = checkout::source() / "tools";

// As the benchmark counts it: each force at its own instant.
diagnose::Recording recorded() {
  return diagnose::loadRecording(checkout::recordings() / "emps/emps.csv",
                                 {.joints = 1,
                                  .columns = kTools / "diagnose/maps/emps.toml",
                                  .torque_timing = diagnose::TorqueTiming::kSampled});
}

}  // namespace

TEST_CASE("the published model of EMPS has the published error") {
  const diagnose::Recording recording = recorded();
  const model::ModelDescription published = app::loadModel(kTools / "studies/measured/emps_published.toml");
  const study::RelativeError error = study::relativeError(recording, published, 0.7);
  CHECK(error.all_percent == doctest::Approx(4.08).epsilon(0.0015));
  CHECK(error.train_percent < error.all_percent);
  CHECK(error.all_percent < error.heldout_percent);

  // Held until the next sample, as a converter does, the force fits better still.
  diagnose::Recording held = recording;
  held.torque_timing = diagnose::TorqueTiming::kHeld;
  CHECK(study::relativeError(held, published, 0.7).all_percent < error.all_percent);

  const model::ModelDescription mass_only = app::loadModel(kTools / "diagnose/maps/emps_inertia.toml");
  CHECK(study::relativeError(recording, mass_only, 0.7).all_percent > 60.0);
}

TEST_CASE("recordings that the benchmark's error is not made for are refused") {
  const model::ModelDescription model = app::loadModel(kTools / "studies/measured/emps_published.toml");
  const model::ModelDescription two_joints =
      app::loadModel(checkout::source() / "firmware_app/config/models/adult.toml");
  diagnose::Recording recording = recorded();
  CHECK_THROWS_AS(study::relativeError(recording, two_joints, 0.7), std::invalid_argument);
  recording.segments.push_back(recording.segments.front());
  CHECK_THROWS_AS(study::relativeError(recording, model, 0.7), std::invalid_argument);
}
