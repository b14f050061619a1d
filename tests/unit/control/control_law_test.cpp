#include "core/control/control_law.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/joint_pair.hpp"

using patella::JointMatrix;
using patella::JointVector;
using namespace patella::control;
using patella::test::pair;

namespace {

constexpr double kDt_s = 1e-3;

/// Two-link leg of an adult in the vertical plane, written out here so that the law is not tested against the
/// model code it will run with.
struct Leg {
  static constexpr double kA = 8.0 * 0.04 + 4.0 * 0.16 + 0.11;
  static constexpr double kB = 4.0 * 0.04 + 0.06;
  static constexpr double kC = 4.0 * 0.4 * 0.2;

  JointVector q = pair(-1.0, -0.5);
  JointVector dq = pair(0.0, 0.0);
  JointVector disturbance_Nm = pair(0.0, 0.0);

  JointMatrix inertia() const {
    const double c2 = std::cos(q[1]);
    JointMatrix m(2, 2);
    m << kA + kB + 2.0 * kC * c2, kB + kC * c2, kB + kC * c2, kB;
    return m;
  }
  JointVector gravity() const {
    constexpr double kG = 9.81;
    const double shank = 4.0 * 0.2 * std::cos(q[0] + q[1]);
    return pair(kG * ((8.0 * 0.2 + 4.0 * 0.4) * std::cos(q[0]) + shank), kG * shank);
  }
  patella::model::ModelTerms terms() const {
    const double s2 = kC * std::sin(q[1]);
    const JointVector coriolis = pair(-s2 * (2.0 * dq[0] * dq[1] + dq[1] * dq[1]), s2 * dq[0] * dq[0]);
    const JointMatrix m = inertia();
    const JointMatrix inverse = m.inverse();
    const JointVector bias = coriolis + gravity();
    return {m, inverse, bias, pair(0.0, 0.0), JointVector(-(inverse * bias))};
  }
  JointVector unknownDynamics() const { return inertia().inverse() * disturbance_Nm; }

  /// Ten symplectic steps within one period of the loop, torque held.
  void advance(const JointVector& torque) {
    for (int i = 0; i < 10; ++i) {
      const auto t = terms();
      dq += 0.1 * kDt_s * (t.f + t.inverse_inertia * (torque + disturbance_Nm));
      q += 0.1 * kDt_s * dq;
    }
  }
};

ControlGains gains() {
  return {.stiffness_Nm_rad = pair(0.0, 0.0), .damping_Nms_rad = pair(0.0, 0.0)};
}

ReferencePoint at(const JointVector& q) {
  return {q, pair(0.0, 0.0), pair(0.0, 0.0)};
}

ControlOutput compute(const ControlLaw& law, const Leg& leg, const ReferencePoint& reference,
                      const JointVector& emg_torque = pair(0.0, 0.0)) {
  const auto terms = leg.terms();
  const JointVector gravity = leg.gravity();
  const JointVector f_hat = leg.unknownDynamics();
  return law.compute({terms, gravity, reference, leg.q, leg.dq, emg_torque, f_hat});
}

using Reference = std::function<ReferencePoint(double)>;

/// Runs the leg under the law; returns the largest deviation from the reference in the last second, rad.
double finalError(const ControlGains& with, Leg& leg, const Reference& reference, double duration_s) {
  const ControlLaw law(2, with);
  double error = 0.0;
  const int steps = static_cast<int>(std::lround(duration_s / kDt_s));
  for (int k = 0; k < steps; ++k) {
    leg.advance(compute(law, leg, reference(k * kDt_s)).total);
    if (k >= steps - 1000) {
      error = std::max(error, (leg.q - reference((k + 1) * kDt_s).q).cwiseAbs().maxCoeff());
    }
  }
  return error;
}

}  // namespace

TEST_CASE("gravity compensation alone holds a pose that falls without it") {
  Leg held;
  const JointVector pose = held.q;
  const Reference stay = [&](double) { return at(pose); };
  ControlGains with = gains();
  with.gravity = 1.0;
  CHECK(finalError(with, held, stay, 3.0) < 1e-6);
  Leg fallen;
  CHECK(finalError(gains(), fallen, stay, 3.0) > 0.5);
}

TEST_CASE("impedance with gravity compensation converges to the reference") {
  Leg leg;
  ControlGains with = gains();
  with.gravity = 1.0;
  with.stiffness_Nm_rad = pair(120.0, 60.0);
  with.damping_Nms_rad = pair(25.0, 8.0);
  const JointVector goal = pair(-0.6, -1.0);
  CHECK(finalError(
            with, leg, [&](double) { return at(goal); }, 6.0) < 1e-4);
  CHECK(leg.dq.norm() < 1e-3);
}

TEST_CASE("stiffness is the torque per displacement that the patient feels") {
  Leg leg;
  leg.disturbance_Nm = pair(6.0, -3.0);
  const JointVector goal = leg.q;
  ControlGains with = gains();
  with.gravity = 1.0;
  with.stiffness_Nm_rad = pair(120.0, 60.0);
  with.damping_Nms_rad = pair(25.0, 8.0);
  finalError(
      with, leg, [&](double) { return at(goal); }, 8.0);
  CHECK(leg.q[0] - goal[0] == doctest::Approx(6.0 / 120.0).epsilon(1e-3));
  CHECK(leg.q[1] - goal[1] == doctest::Approx(-3.0 / 60.0).epsilon(1e-3));
}

TEST_CASE("compensation cancels a constant disturbance") {
  ControlGains with = gains();
  with.gravity = 1.0;
  with.stiffness_Nm_rad = pair(120.0, 60.0);
  with.damping_Nms_rad = pair(25.0, 8.0);
  Leg without_compensation;
  without_compensation.disturbance_Nm = pair(6.0, -3.0);
  Leg with_compensation = without_compensation;
  const JointVector goal = pair(-0.8, -0.7);
  const Reference stay = [&](double) { return at(goal); };
  CHECK(finalError(with, without_compensation, stay, 6.0) > 0.04);
  with.compensation = 1.0;
  CHECK(finalError(with, with_compensation, stay, 6.0) < 1e-4);
}

TEST_CASE("the model's feed-forward follows a moving reference that feedback alone lags behind") {
  ReferenceTrajectory trajectory(
      2, {.blend_s = 1.0,
          .motion = {SinusoidMotion{-1.0, 0.35, 0.5, 0.0}, SinusoidMotion{-0.9, 0.45, 0.5, 0.8}}});
  Leg feedback_only;
  Leg with_model;
  trajectory.start(with_model.q);
  const Reference moving = [&](double t_s) { return trajectory.at(t_s); };
  ControlGains with = gains();
  with.gravity = 1.0;
  with.stiffness_Nm_rad = pair(60.0, 30.0);
  with.damping_Nms_rad = pair(12.0, 4.0);
  const double lag = finalError(with, feedback_only, moving, 5.0);
  with.model = 1.0;
  const double residual = finalError(with, with_model, moving, 5.0);
  CHECK(lag > 0.05);
  CHECK(residual < 0.05 * lag);
}

TEST_CASE("gravity and model together are the inverse dynamics: nothing counts twice") {
  Leg leg;
  leg.dq = pair(0.7, -1.3);
  ControlGains with = gains();
  with.gravity = 1.0;
  with.model = 1.0;
  ReferencePoint reference = at(leg.q);
  reference.ddq = pair(2.0, -5.0);
  const ControlOutput out = compute(ControlLaw(2, with), leg, reference);
  const auto terms = leg.terms();
  const JointVector expected = terms.inertia * reference.ddq + terms.bias_Nm;
  CHECK((out.total - expected).norm() < 1e-12);
  CHECK((out.gravity - leg.gravity()).norm() < 1e-12);
}

TEST_CASE("what the drive itself adds is not balanced: it would come back to it") {
  Leg leg;
  leg.dq = pair(0.7, -1.3);
  ControlGains with = gains();
  with.model = 1.0;
  const ReferencePoint reference = at(leg.q);
  const JointVector none = pair(0.0, 0.0);
  auto lagging = leg.terms();
  const auto plain = leg.terms();
  lagging.drive_Nm = pair(5.0, -3.0);
  lagging.bias_Nm -= lagging.drive_Nm;
  const auto model = [&](const patella::model::ModelTerms& terms) {
    return ControlLaw(2, with).compute({terms, leg.gravity(), reference, leg.q, leg.dq, none, none}).model;
  };
  CHECK((model(lagging) - model(plain)).norm() < 1e-12);
}

TEST_CASE("terms add up to the total and EMG acts with its gain, against the patient where negative") {
  Leg leg;
  leg.dq = pair(0.4, 0.2);
  leg.disturbance_Nm = pair(1.0, 2.0);
  ControlGains with = gains();
  with.gravity = 0.8;
  with.model = 0.6;
  with.emg = -1.5;
  with.compensation = 0.5;
  with.stiffness_Nm_rad = pair(10.0, 20.0);
  with.damping_Nms_rad = pair(1.0, 2.0);
  const ControlOutput out = compute(ControlLaw(2, with), leg, at(pair(0.0, 0.0)), pair(4.0, -2.0));
  CHECK(out.emg == pair(-6.0, 3.0));
  CHECK((out.compensation - pair(-0.5, -1.0)).norm() < 1e-12);
  CHECK((out.impedance - pair(10.0 * 1.0 - 0.4, 20.0 * 0.5 - 0.4)).norm() < 1e-12);
  const JointVector sum = out.gravity + out.model + out.emg + out.impedance + out.compensation;
  CHECK((out.total - sum).norm() < 1e-12);
}

TEST_CASE("zero gains give zero torque whatever the inputs hold; a broken input in use stays visible") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Leg leg;
  const auto terms = leg.terms();
  const JointVector broken = pair(kNan, kNan);
  const ReferencePoint reference{broken, broken, broken};
  const ControlInput input{terms, broken, reference, broken, broken, broken, broken};
  CHECK(ControlLaw(2, gains()).compute(input).total == pair(0.0, 0.0));
  ControlGains with = gains();
  with.compensation = 1.0;
  CHECK(std::isnan(ControlLaw(2, with).compute(input).total[0]));
}

TEST_CASE("the law allocates nothing") {
  ControlGains with = gains();
  with.gravity = with.model = with.emg = with.compensation = 1.0;
  const ControlLaw law(2, with);
  const Leg leg;
  const auto terms = leg.terms();
  const JointVector v = pair(1.0, 2.0);
  const ReferencePoint reference{v, v, v};
  const auto before = patella::test::allocationCount();
  const ControlOutput out = law.compute({terms, v, reference, v, v, v, v});
  const auto after = patella::test::allocationCount();
  CHECK(after == before);
  CHECK(out.total.allFinite());
}

TEST_CASE("gains out of range are refused by name") {
  ControlGains with = gains();
  with.compensation = 1.1;
  CHECK_THROWS_WITH_AS(ControlLaw(2, with), "control.compensation = 1.1, expected 0 to 1",
                       std::invalid_argument);
  with = gains();
  with.stiffness_Nm_rad[1] = -1.0;
  CHECK_THROWS_WITH_AS(ControlLaw(2, with), "control.stiffness_Nm_rad[2] = -1, expected 0 to 3000",
                       std::invalid_argument);
  with = gains();
  with.damping_Nms_rad = JointVector::Zero(1);
  CHECK_THROWS_WITH_AS(ControlLaw(2, with),
                       "number of values of control.damping_Nms_rad = 1, expected one per joint (2)",
                       std::invalid_argument);
  with = gains();
  with.gravity = std::nan("");
  CHECK_THROWS_AS(ControlLaw(2, with), std::invalid_argument);
}
