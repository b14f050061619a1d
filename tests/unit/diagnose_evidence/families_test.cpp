#include "tools/diagnose/evidence/families.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/evidence/drive_kinds.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

struct Scene {
  Recording recording = swinging(30.0, 0.0, [](const Motion&) { return 0.0; });
  Dataset data{std::span(&recording, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0}};
  std::shared_ptr<const LinkTorque> link = std::make_shared<const LinkTorque>(linkTorque(data, pendulum()));

  const Family family(const char* kind) const {
    for (const Family& one : driveFamilies(data, link)) {
      if (one.kind == kind) {
        return one;
      }
    }
    FAIL("no family of kind " << kind);
    return {};
  }
};

TEST_CASE("every effect of the library has a family, and every family of a name is an effect") {
  const Scene scene;
  std::set<std::string> kinds;
  std::vector<Family> all = motionFamilies(scene.data, pendulum(), std::vector<int>{1});
  for (auto& more :
       {driveFamilies(scene.data, scene.link), oscillatingFamilies(scene.data, scene.data.driveTorque())}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const Family& family : all) {
    if (family.isNamed()) {
      kinds.insert(family.kind);
      CHECK_MESSAGE(model::findEffect(family.kind) != nullptr, family.kind);
    }
  }
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    CHECK_MESSAGE(kinds.contains(std::string(descriptor->kind)), descriptor->kind);
  }
}

TEST_CASE("families of the drive are made of motion: the recorded torque is not in them") {
  const Scene scene;
  Recording other = scene.recording;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 2.0);
  for (double& torque_Nm : other.torque_Nm[0]) {
    torque_Nm = normal(random);
  }
  const Dataset data(std::span(&other, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0});
  const auto link = std::make_shared<const LinkTorque>(linkTorque(data, pendulum()));
  const std::vector<Family> same = driveFamilies(scene.data, scene.link), changed = driveFamilies(data, link);
  REQUIRE(same.size() == kDriveKinds.size());
  for (std::size_t f = 0; f < same.size(); ++f) {
    const std::vector<double>& nu = same[f].grid.front();
    CHECK_MESSAGE((same[f].columns(nu) - changed[f].columns(nu)).norm() == 0.0, same[f].kind);
  }
}

TEST_CASE("lag and delay lead the link's torque") {
  const Scene scene;
  const Column torque = scene.data.driveTorque();
  const Eigen::VectorXd slope = scene.family("actuator_lag").columns({});
  const double step_s = 1.0 / scene.data.rate_Hz();
  for (Eigen::Index i = 50; i + 50 < torque.size(); i += 37) {
    CHECK(slope[i] ==
          doctest::Approx((torque[i + 1] - torque[i - 1]) / (2.0 * step_s)).epsilon(0.05).scale(10.0));
  }
  const double delay_s = 3.0 * step_s;
  const Eigen::VectorXd late = scene.family("actuator_delay").columns(std::vector<double>{delay_s}) * delay_s;
  for (Eigen::Index i = 50; i + 50 < torque.size(); i += 37) {
    CHECK(late[i] == doctest::Approx(torque[i + 3] - torque[i]).epsilon(0.01).scale(1.0));
  }
}

TEST_CASE("lines are found over time and over position") {
  const Scene scene;
  Eigen::VectorXd tremor(scene.data.rows());
  for (Eigen::Index i = 0; i < tremor.size(); ++i) {
    tremor[i] = 0.1 * std::sin(2.0 * std::numbers::pi * 5.3 * scene.data.time_s()[i]);
  }
  const Eigen::VectorXd ripple = jointColumns(
      scene.data, 0, {[&](std::size_t s, std::size_t i) {
        return 0.1 * std::sin(2.0 * std::numbers::pi * 2.2 * scene.data.series()[s].states[i].q[0]);
      }});
  const auto nearest = [](const std::vector<Family>& families, const char* kind, double wanted) {
    double best = 1e9;
    for (const Family& family : families) {
      if (family.kind == kind) {
        best = std::min(best, std::abs(family.grid.front().front() - wanted));
      }
    }
    return best;
  };
  CHECK(nearest(oscillatingFamilies(scene.data, tremor), "tremor", 5.3) < 0.02);
  CHECK(nearest(oscillatingFamilies(scene.data, ripple), "torque_ripple", 2.2) < 0.2);
}

}  // namespace
}  // namespace patella::diagnose::evidence
