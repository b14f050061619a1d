// A long random session through limiter and state machine, wired as in a tick: what must hold always, holds.
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/safety/safety_limiter.hpp"
#include "core/safety/state_machine.hpp"
#include "tests/unit/safety/safety_fixture.hpp"

using patella::JointVector;
using namespace patella::safety;
using patella::test::narrowLimits;

namespace {

constexpr int kSteps = 100000;
constexpr int kHealthyTicks = 20;
constexpr double kDt_s = 1e-3;

class Session {
 public:
  struct Tick {
    StateInputs inputs;
    JointVector demand = JointVector::Zero(2);
    JointVector q = JointVector::Zero(2);
    JointVector dq = JointVector::Zero(2);
  };

  Tick next() {
    Tick tick;
    // Buttons are pressed for a while; faults and outages come rarely and last, so that every state is lived
    // in.
    enable_ = chance(0.03) ? !enable_ : enable_;
    reset_ = chance(0.02) ? !reset_ : reset_;
    if (fault_ticks_ == 0 && chance(0.003)) {
      fault_ = static_cast<Fault>(std::uniform_int_distribution<int>(0, kFaultCount - 1)(generator_));
      fault_ticks_ = std::uniform_int_distribution<int>(1, 30)(generator_);
    }
    if (fault_ticks_ > 0) {
      --fault_ticks_;
      tick.inputs.faults.add(fault_);
    }
    tick.inputs.inputs_valid = !chance(0.001);
    tick.inputs.enable = enable_;
    tick.inputs.reset = reset_;
    for (int j = 0; j < 2; ++j) {
      demand_[j] += normal_(generator_) - 0.02 * demand_[j];
      tick.demand[j] = chance(0.02) ? 20.0 * demand_[j] : demand_[j];
      q_[j] += 0.02 * normal_(generator_) - 0.01 * (q_[j] + 0.7);
      tick.q[j] = q_[j];
      tick.dq[j] = normal_(generator_);
    }
    if (chance(0.0005)) {
      constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()};
      (chance(0.5) ? tick.demand : tick.q)[chance(0.5) ? 1 : 0] = kBad[chance(0.5) ? 1 : 0];
    }
    return tick;
  }

 private:
  bool chance(double probability) { return uniform_(generator_) < probability; }

  std::mt19937_64 generator_{20231};
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::normal_distribution<double> normal_;
  bool enable_ = false;
  bool reset_ = false;
  Fault fault_ = Fault::kEmergencyStop;
  int fault_ticks_ = 0;
  JointVector demand_ = JointVector::Zero(2);
  JointVector q_ = JointVector::Constant(2, -0.7);
};

bool latched(State state) {
  return state == State::kLimited || state == State::kFault;
}

}  // namespace

TEST_CASE("a hundred thousand random ticks") {
  Session session;
  SafetyLimiter limiter(2, narrowLimits());
  StateMachine machine(kHealthyTicks);
  StateOutput before;
  JointVector last = JointVector::Zero(2);
  bool reset_before = true;
  bool enable_before = true;
  int healthy = 0;
  std::array<int, kStateCount> visits{};
  int faults_while_active = 0;

  for (int k = 0; k < kSteps; ++k) {
    Session::Tick tick = session.next();
    const bool finite = tick.demand.allFinite() && tick.q.allFinite();
    const LimiterOutput limited = limiter.apply(tick.demand, tick.q, tick.dq, kDt_s);
    tick.inputs.faults = tick.inputs.faults | limited.faults;
    const StateOutput out = machine.step(tick.inputs);
    JointVector command = limited.torque_Nm;
    if (!out.torque_allowed) {
      limiter.stop();
      command.setZero();
    }
    healthy = tick.inputs.inputs_valid && !tick.inputs.faults.any() ? healthy + 1 : 0;
    const bool reset_edge = tick.inputs.reset && !reset_before;
    const bool enable_edge = tick.inputs.enable && !enable_before;

    // Torque: none on a fault, none while latched, always finite, within limit and rate.
    REQUIRE((finite || limited.faults.has(Fault::kNotFinite)));
    if (tick.inputs.faults.any() || latched(out.state) || !tick.inputs.inputs_valid) {
      REQUIRE_FALSE(out.torque_allowed);
      REQUIRE(command == JointVector::Zero(2));
    }
    for (int j = 0; j < 2; ++j) {
      const JointLimits of_joint = narrowLimits().joint[static_cast<std::size_t>(j)];
      REQUIRE(std::abs(command[j]) <= of_joint.torque_Nm);
      const bool towards_zero = command[j] * last[j] >= 0.0 && std::abs(command[j]) <= std::abs(last[j]);
      const double change = std::abs(command[j] - last[j]);
      REQUIRE((towards_zero || change <= of_joint.torque_rate_Nm_s * kDt_s + 1e-12));
    }
    // States: latched ones let go only on an edge of reset after health, active comes only from ready.
    if (latched(before.state) && !latched(out.state)) {
      REQUIRE(out.state == State::kReady);
      REQUIRE(reset_edge);
      REQUIRE(healthy >= kHealthyTicks);
    }
    REQUIRE_FALSE((before.state == State::kFault && out.state == State::kLimited));
    REQUIRE(out.entered_active == (out.state == State::kActive && before.state != State::kActive));
    if (out.entered_active) {
      REQUIRE(before.state == State::kReady);
      REQUIRE(enable_edge);
    }
    REQUIRE(out.entered_stop == (before.torque_allowed && !out.torque_allowed));
    REQUIRE(latched(out.state) == out.latched.any());
    REQUIRE(latched(out.state) == (out.first_cause != Fault::kCount));

    ++visits[static_cast<std::size_t>(out.state)];
    faults_while_active += before.torque_allowed && tick.inputs.faults.any() ? 1 : 0;
    before = out;
    last = command;
    reset_before = tick.inputs.reset;
    enable_before = tick.inputs.enable;
  }
  // The walk is worth something only where it has been everywhere.
  for (const int count : visits) {
    CHECK(count > 500);
  }
  CHECK(faults_while_active > 50);
}
