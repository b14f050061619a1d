// The held-out part begins as the machine stood at its first row.
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/lateness.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

/// Swings, and stands still from 5 s before the cut to 3 s after it.
Recording withPause() {
  Recording recording = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  const std::size_t first = 23 * 200, end = 31 * 200;
  std::vector<double>& position = recording.position_rad[0];
  for (std::size_t i = first; i < end; ++i) {
    position[i] = position[first];
  }
  for (std::size_t i = end; i < position.size(); ++i) {
    position[i] = position[first] + motionAt(recording.time_s[i - end]).q;
  }
  return recording;
}

}  // namespace

TEST_CASE("friction that stands is the same in the held-out part as in the whole recording") {
  const Recording recording = withPause();
  const SplitRecordings parts = split(std::span(&recording, 1), 0.3);
  const Dataset whole(std::span(&recording, 1), {}), heldout(parts.heldout, {});
  const model::DynamicsModel machine = model::makeModel(pendulum());
  const auto frictionIn = [&](const Dataset& data) {
    constexpr std::array kSoftContact{2.0, 200.0};
    return data.effectTorque(
        *model::makeEffect("presliding_hysteresis", 0, machine.mechanism(), kSoftContact));
  };
  const Column of_whole = frictionIn(whole), of_heldout = frictionIn(heldout);
  CHECK(heldout.time_s()[0] == doctest::Approx(28.0).epsilon(0.01));
  // It stands where the last motion left it, far from where a contact at rest begins.
  REQUIRE(std::abs(of_heldout[0]) > 0.2);
  for (Eigen::Index i = 0; i < heldout.rows() && heldout.time_s()[i] < 30.5; ++i) {
    Eigen::Index same = 0;
    (whole.time_s().array() - heldout.time_s()[i]).abs().minCoeff(&same);
    REQUIRE(of_heldout[i] == doctest::Approx(of_whole[same]).epsilon(0.05));
  }
}

TEST_CASE("a late drive's error is taken off, and not that of a torque column that comes late") {
  constexpr double kLate_s = 0.015;
  const auto leftOf = [](double late_s) {
    Recording recording = swinging(20.0, 0.0, [](const Motion&) { return 0.0; });
    Dataset data(std::span(&recording, 1), {});
    const Column torque = data.driveTorque();
    const Column shifted = data.column([&](const Series& series, std::size_t i) -> JointVector {
      const double at = static_cast<double>(i) - late_s * series.rate_Hz;
      const double within = std::clamp(at, 0.0, static_cast<double>(series.states.size() - 2));
      const auto before = static_cast<std::size_t>(within);
      const double share = within - static_cast<double>(before);
      return (1.0 - share) * series.measured_torque_Nm[before] +
             share * series.measured_torque_Nm[before + 1];
    });
    const Column error = torque - shifted;
    return besideLateness(data, error).norm() / error.norm();
  };
  CHECK(leftOf(kLate_s) < 0.1);
  CHECK(leftOf(-kLate_s) == doctest::Approx(1.0));
}
