// Inputs of networks.
#include "core/tick/front_end.hpp"

#include <doctest/doctest.h>

#include "tests/unit/tick/simulated_leg.hpp"

using namespace patella;
using namespace patella::tick;

namespace {

/// Says that the joint torque rises by slope_Nm_s, from nothing at reset().
class Ramp final : public estimation::Observer {
 public:
  explicit Ramp(JointVector slope_Nm_s) : slope_Nm_s_(std::move(slope_Nm_s)) {}
  void reset(const estimation::ObserverInput& /*input*/) noexcept override { time_s_ = 0.0; }
  JointVector update(const estimation::ObserverInput& input) noexcept override {
    time_s_ += input.dt_s;
    return input.terms.inverse_inertia * (time_s_ * slope_Nm_s_);
  }

 private:
  JointVector slope_Nm_s_;
  double time_s_ = 0.0;
};

}  // namespace

TEST_CASE(
    "a steady rise of the observer's torque shows as slope times time constant, and restart() forgets it") {
  FrontEnd front({.estimate_cutoff_Hz = 0.0, .emg_gain_Nm = {}}, paperModel(),
                 std::make_unique<Ramp>(pair(2.0, -0.5)));
  Measurement sample;
  sample.position_rad = pair(-1.2, -0.6);
  sample.encoder_steps = 1;
  FeatureVector features{};
  for (int k = 0; k < 3000; ++k) {
    front.update(sample, {}, pair(0.0, 0.0), 1e-3 * k);
  }
  front.features(features);
  for (int i = 0; i < kRiseTimes; ++i) {
    const auto first = static_cast<std::size_t>(kRise + i * kMaxJoints);
    const double time_s = kRiseTimes_s[static_cast<std::size_t>(i)];
    CHECK(features[first] == doctest::Approx(2.0 * time_s).epsilon(0.03));
    CHECK(features[first + 1] == doctest::Approx(-0.5 * time_s).epsilon(0.03));
  }
  CHECK(featureNames()[kRise + 2 * kMaxJoints + 1] == "d_rise_180ms2_Nm");
  front.restart();
  front.features(features);
  CHECK(features[kRise] == 0.0);
}

TEST_CASE("a network may ask for features of the joints that there are, and of no others") {
  CHECK(selectFeatures({"q1_rad", "activation4", "d_rise_60ms2_Nm", "time_s"}, 2) ==
        FeatureSelection{kPosition, kActivation + 3, kRise + kMaxJoints + 1, kTime});
  CHECK(selectFeatures({"ddq_hat8_rad_s2"}, kMaxJoints) == FeatureSelection{kAcceleration + 7});
  CHECK_THROWS_WITH_AS(selectFeatures({"q3_rad"}, 2),
                       doctest::Contains("feature 'q3_rad' of the network is unknown"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(selectFeatures({"tau2_Nm"}, 1), doctest::Contains("tau1_Nm tau_emg1_Nm activation1"),
                       std::invalid_argument);
}
