// Phase margins against what is known by hand, and against loops that are simulated until they settle or
// swing.
#include "core/control/stability_margin.hpp"

#include <cmath>
#include <deque>
#include <numbers>

#include <doctest/doctest.h>

#include "core/control/drive_anticipation.hpp"

using namespace patella;
using namespace patella::control;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Where |K_p + K_d s| = |I s²|, rad/s.
double crossover(double stiffness, double damping, double inertia) {
  const double d2 = damping * damping;
  return std::sqrt((d2 + std::sqrt(d2 * d2 + 4.0 * inertia * inertia * stiffness * stiffness)) /
                   (2.0 * inertia * inertia));
}

/// A joint without gravity or friction whose drive is late, held at 0 by the impedance at the state ahead:
/// its largest angle in the second half of 4 s, as a share of where it began.
double simulated(const JointLoop& loop, double model_inertia, double inertia) {
  model::ModelTerms terms;
  terms.inertia = JointMatrix::Constant(1, 1, model_inertia);
  terms.inverse_inertia = JointMatrix::Constant(1, 1, 1.0 / model_inertia);
  terms.bias_Nm = terms.drive_Nm = terms.f = JointVector::Zero(1);
  DriveAnticipation ahead(1, {model::DriveLateness{.delay_s = loop.lateness_s}}, loop.period_s);
  // A command acts a tick after its sample, held for another.
  std::deque<double> under_way(static_cast<std::size_t>(std::lround(loop.lateness_s / loop.period_s)) + 1,
                               0.0);
  double q = 0.1;
  double dq = 0.0;
  double largest = 0.0;
  const int ticks = static_cast<int>(4.0 / loop.period_s);
  for (int k = 0; k < ticks; ++k) {
    JointVector q_ahead = JointVector::Constant(1, q);
    JointVector dq_ahead = JointVector::Constant(1, dq);
    ahead.lookAhead(terms, JointVector::Zero(1), loop.lateness_s, q_ahead, dq_ahead);
    const double torque = -loop.stiffness_Nm_rad * q_ahead[0] - loop.damping_Nms_rad * dq_ahead[0];
    ahead.commanded(JointVector::Constant(1, torque));
    under_way.push_back(torque);
    const double ddq = under_way.front() / inertia;
    under_way.pop_front();
    q += loop.period_s * dq + 0.5 * loop.period_s * loop.period_s * ddq;
    dq += loop.period_s * ddq;
    largest = k > ticks / 2 ? std::max(largest, std::abs(q)) : 0.0;
    if (!(std::abs(q) < 1e6)) {
      return 1e6;
    }
  }
  return largest / 0.1;
}

}  // namespace

TEST_CASE(
    "spring and damper on an inertia: the margin is the textbook's, less what a tick and its hold turn") {
  for (const double damping : {3.0, 10.0, 30.0}) {
    for (const double period_s : {1e-4, 1e-3}) {
      CAPTURE(damping);
      CAPTURE(period_s);
      const JointLoop loop{.stiffness_Nm_rad = 60.0, .damping_Nms_rad = damping, .period_s = period_s};
      const PhaseMargin margin = phaseMargin(loop, 0.5, 0.5);
      const double omega = crossover(60.0, damping, 0.5);
      CHECK(margin.frequency_Hz == doctest::Approx(omega / (2.0 * std::numbers::pi)).epsilon(0.02));
      const double expected_deg = (std::atan(damping * omega / 60.0) - 1.5 * omega * period_s) * kDegrees;
      CHECK(std::abs(margin.margin_deg - expected_deg) < 0.3);
    }
  }
}

TEST_CASE("a spring alone has none, and without feedback there is nothing to swing") {
  CHECK(phaseMargin({.stiffness_Nm_rad = 60.0}, 0.5, 0.5).margin_deg <= 0.0);
  const PhaseMargin none = phaseMargin({}, 0.5, 0.5);
  CHECK(std::isinf(none.margin_deg));
  CHECK(none.frequency_Hz == 0.0);
}

TEST_CASE("a velocity derived from position costs margin, and so does an inertia that is off") {
  const JointLoop measured{.stiffness_Nm_rad = 60.0, .damping_Nms_rad = 6.0, .compensation = 0.8};
  JointLoop derived = measured;
  derived.velocity_cutoff_Hz = 20.0;
  CHECK(phaseMargin(derived, 0.2, 0.2).margin_deg < phaseMargin(measured, 0.2, 0.2).margin_deg - 5.0);
  CHECK(leastPhaseMargin(measured, 0.2).margin_deg < phaseMargin(measured, 0.2, 0.2).margin_deg);
}

TEST_CASE("with the model's own inertia, lateness that is looked ahead over costs nothing") {
  const JointLoop prompt{.stiffness_Nm_rad = 60.0, .damping_Nms_rad = 6.0, .period_s = 1e-4};
  JointLoop late = prompt;
  late.lateness_s = 0.03;
  CHECK(simulated(late, 0.4, 0.4) < 0.01);
  CHECK(phaseMargin(late, 0.4, 0.4).margin_deg > 30.0);
}

TEST_CASE("simulated loops swing up where the margin is negative, and settle where it is not") {
  int swinging = 0;
  int settling = 0;
  for (const double lateness_s : {0.0, 0.005, 0.015, 0.03, 0.05}) {
    for (const double share : {0.25, 0.4, 0.55, 0.7, 1.0, 1.3}) {
      for (const double inertia : {0.02, 0.08, 0.2, 0.5}) {
        const JointLoop loop{.stiffness_Nm_rad = 60.0, .damping_Nms_rad = 6.0, .lateness_s = lateness_s};
        const double margin_deg = phaseMargin(loop, inertia, share * inertia).margin_deg;
        CAPTURE(lateness_s);
        CAPTURE(share);
        CAPTURE(inertia);
        CAPTURE(margin_deg);
        // Within some degrees the simulation's own way of holding and sampling decides.
        if (margin_deg < -10.0) {
          CHECK(simulated(loop, inertia, share * inertia) > 1.0);
          ++swinging;
        } else if (margin_deg > 10.0) {
          CHECK(simulated(loop, inertia, share * inertia) < 0.5);
          ++settling;
        }
      }
    }
  }
  CHECK(swinging >= 10);
  CHECK(settling >= 30);
}
