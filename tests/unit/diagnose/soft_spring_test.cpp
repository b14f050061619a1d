// A drive's spring gives no more than half a radian: what is softer is a torque at one frequency, taken for
// it.
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {
namespace {

/// ν of a drive's spring of the usual inertia and damping that resonates so fast.
std::vector<double> resonating(double resonance_rad_s) {
  return {resonance_rad_s, 0.0, 0.0};
}

}  // namespace

TEST_CASE(
    "a spring that gives more than half a radian at the torque's rms is refused, and a stiffer one is not") {
  const Recording recording = swinging(20.0, 0.05, [](const Motion&) { return 0.0; });
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const auto all = recipes(data, pendulum().mechanism, std::vector<std::string>{"transmission_elasticity"},
                           {}, std::array{0.05});
  REQUIRE(all.size() == 1);
  const Recipe& spring = *all.front();
  const double torque_rms_Nm =
      std::sqrt(std::inner_product(recording.torque_Nm[0].begin(), recording.torque_Nm[0].end(),
                                   recording.torque_Nm[0].begin(), 0.0) /
                static_cast<double>(recording.torque_Nm[0].size()));
  const double softest_Nm_rad = torque_rms_Nm / 0.5;
  const auto at = [&spring](double stiffness_Nm_rad) {
    // It grows with the square of the resonance.
    constexpr double kSome_rad_s = 50.0;
    return resonating(kSome_rad_s *
                      std::sqrt(stiffness_Nm_rad / spring.parameters({}, resonating(kSome_rad_s)).front()));
  };

  CHECK(spring.beyond({}, at(0.9 * softest_Nm_rad)) == "stiffness_Nm_rad");
  CHECK(spring.beyond({}, at(1.1 * softest_Nm_rad)).empty());
}

}  // namespace patella::diagnose
