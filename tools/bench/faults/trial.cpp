#include "tools/bench/faults/trial.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "firmware_app/loop/loop.hpp"
#include "sim/loop_faults.hpp"
#include "sim/simulated_bus.hpp"
#include "tools/bench/faults/expectation.hpp"
#include "tools/bench/faults/scenario.hpp"

namespace patella::bench {
namespace {

/// A command may round to the bus's resolution and back.
constexpr double kResolution_Nm = 0.0006;

// Reads every command that the loop sends, as the drives would, and holds it against the limits.
class Judge final : public can::Bus {
 public:
  Judge(can::Bus& bus, sim::Rig& rig, const app::RunConfig& config, const gpio::SimulatedPins& pins)
      : bus_(bus),
        rig_(rig),
        config_(config),
        pins_(pins),
        command_(config.bus.database.message("TorqueCommand")) {
    torque_ = {command_.slot("Torque1"), command_.slot("Torque2")};
    enable_ = command_.slot("Enable");
    state_ = command_.slot("State");
  }

  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    if (!started_) {
      started_ = true;
      epoch_ns_ = now_ns;
    }
    // What the tick before left: the line must not be up without an enabling command.
    violations += pins_.driveEnable() && !enabled_ ? 1U : 0U;
    const std::size_t count = bus_.receive(frames, now_ns);
    judgeDrives(now_ns);
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    judge(frame, seconds(now_ns));
    return bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

  std::uint64_t violations = 0;
  std::uint64_t enabled_after_fault = 0;
  double first_active_s = -1.0;
  double stopped_s = -1.0;
  /// Since when the drives have not done what they were told, for longer than the loop needs to see it.
  std::optional<double> disobeyed_s;

 private:
  double seconds(std::int64_t now_ns) const { return static_cast<double>(now_ns - epoch_ns_) * 1e-9; }

  void judge(const can::Frame& frame, double time_s) noexcept {
    const bool enable = command_.signal(enable_).decode(frame) > 0.5;
    const auto state = static_cast<safety::State>(static_cast<int>(command_.signal(state_).decode(frame)));
    bool sound = enable == (state == safety::State::kActive);
    for (std::size_t j = 0; j < torque_.size(); ++j) {
      const double torque_Nm = command_.signal(torque_[j]).decode(frame);
      const safety::JointLimits& limits = config_.tick.limits.joint[j];
      const double growth_Nm =
          torque_Nm * last_Nm_[j] >= 0.0 ? std::abs(torque_Nm) - std::abs(last_Nm_[j]) : std::abs(torque_Nm);
      sound = sound && std::isfinite(torque_Nm) && std::abs(torque_Nm) <= limits.torque_Nm + kResolution_Nm &&
              growth_Nm <= limits.torque_rate_Nm_s / config_.loop.rate_Hz + kResolution_Nm &&
              (enable || torque_Nm == 0.0);
      last_Nm_[j] = torque_Nm;
    }
    violations += sound ? 0U : 1U;
    fault_seen_ = fault_seen_ || state == safety::State::kFault || state == safety::State::kLimited;
    if (enable) {
      first_active_s = first_active_s < 0.0 ? time_s : first_active_s;
      enabled_after_fault += fault_seen_ ? 1U : 0U;
    } else if (first_active_s >= 0.0 && stopped_s < 0.0) {
      stopped_s = time_s;
    }
    enabled_ = enable;
  }

  void judgeDrives(std::int64_t now_ns) noexcept {
    const safety::DriveMonitorSettings& drive = config_.tick.monitors.drive;
    bool astray = false;
    for (std::size_t j = 0; j < last_Nm_.size(); ++j) {
      const double tolerance_Nm = drive.follow_tolerance * config_.tick.limits.joint[j].torque_Nm;
      const double told_Nm = enabled_ ? last_Nm_[j] : 0.0;
      // Half as much again, and what commands may change while the loop waits.
      astray = astray || std::abs(rig_.drive().torque()[static_cast<Eigen::Index>(j)] - told_Nm) >
                             1.5 * tolerance_Nm + 5.0;
    }
    astray = astray && enabled_;
    if (!astray) {
      astray_since_s_.reset();
    } else if (!astray_since_s_) {
      astray_since_s_ = seconds(now_ns);
    }
    if (astray_since_s_ && !disobeyed_s &&
        seconds(now_ns) - *astray_since_s_ > drive.follow_time_s + drive.response_s + 0.002) {
      disobeyed_s = astray_since_s_;
    }
  }

  can::Bus& bus_;
  sim::Rig& rig_;
  const app::RunConfig& config_;
  const gpio::SimulatedPins& pins_;
  can::MessageDecoder command_;
  std::array<std::size_t, 2> torque_{};
  std::size_t enable_ = 0;
  std::size_t state_ = 0;
  bool started_ = false;
  std::int64_t epoch_ns_ = 0;
  std::array<double, 2> last_Nm_{};
  bool enabled_ = false;
  bool fault_seen_ = false;
  std::optional<double> astray_since_s_;
};

// When each fault of the scenario first did something; negative where it never did.
std::vector<double> effects_s(const app::RunConfig& scenario, const sim::Rig& rig) {
  std::vector<double> effects;
  std::size_t of_rig = 0;
  for (const sim::FaultEvent& event : scenario.faults) {
    if (sim::actsOnLoop(event.kind) && event.kind != sim::FaultKind::kClockStep) {
      effects.push_back(event.time_s);
    } else {
      effects.push_back(rig.faults().firstEffects_s().at(of_rig++));
    }
  }
  return effects;
}

// A loop that stands still sees what happens meanwhile when it lives again.
double seenFrom_s(double effect_s, const app::RunConfig& scenario) {
  double seen_s = effect_s;
  for (const sim::FaultEvent& event : scenario.faults) {
    if (event.kind == sim::FaultKind::kLoopStall && event.activeAt(effect_s)) {
      seen_s = std::max(seen_s, event.time_s + event.duration_s);
    }
  }
  return seen_s;
}

// A stall that comes between a fault and its reaction puts off what the loop can do.
double putOff_s(double effect_s, double budget_s, const app::RunConfig& scenario) {
  double later_s = 0.0;
  for (const sim::FaultEvent& event : scenario.faults) {
    const bool between = event.time_s > effect_s && event.time_s <= effect_s + budget_s;
    if (event.kind == sim::FaultKind::kLoopStall && between) {
      later_s += event.duration_s;
    }
  }
  return later_s;
}

Reaction react(sim::FaultKind kind, double effect_s, double budget_s, double stopped_s) {
  const bool stopped = stopped_s >= 0.0;
  return {kind, effect_s, budget_s, stopped ? stopped_s - effect_s : kTrialDuration_s,
          !stopped || stopped_s > effect_s + budget_s + 1e-9};
}

}  // namespace

TrialResult runTrial(const app::RunConfig& scenario, std::uint64_t seed) {
  VirtualClock clock;
  const auto rig = app::makeRig(scenario);
  const auto tick = app::makeTick(scenario);
  can::MeasurementDecoder decoder = app::makeDecoder(scenario);
  can::CommandEncoder encoder = app::makeEncoder(scenario);
  sim::SimulatedBus bus(*rig, clock);
  gpio::SimulatedPins pins;
  Judge judge(bus, *rig, scenario, pins);
  sim::DisturbedClock loop_clock(clock, scenario.faults);
  sim::DisturbedPins loop_pins(pins, loop_clock, scenario.faults);
  app::Loop loop(scenario.loop, loop_clock, judge, loop_pins, decoder, encoder, *tick, nullptr);
  const std::atomic<bool> stop{false};
  loop.run(stop);

  TrialResult result;
  result.seed = seed;
  result.faults = scenario.faults;
  result.limit_violations = judge.violations;
  result.unlatched = judge.enabled_after_fault;
  result.was_active = judge.first_active_s >= 0.0 && judge.first_active_s < kFirstFault_s;
  // The frames that end a run are no reaction.
  const bool at_the_end = judge.stopped_s >= kTrialDuration_s - 1e-3;
  result.stopped_s = at_the_end ? -1.0 : judge.stopped_s;
  result.stopped_before = result.stopped_s >= 0.0 && result.stopped_s < kFirstFault_s;
  result.first_cause = loop.statistics().latched.first();
  const std::vector<double> effects = effects_s(scenario, *rig);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const auto budget_s = reactionBudget_s(scenario.faults[i], scenario);
    if (budget_s && effects[i] >= 0.0) {
      const double effect_s = scenario.faults[i].kind == sim::FaultKind::kLoopStall
                                  ? effects[i]
                                  : seenFrom_s(effects[i], scenario);
      const double allowed_s = *budget_s + putOff_s(effect_s, *budget_s, scenario);
      result.reactions.push_back(react(scenario.faults[i].kind, effect_s, allowed_s, result.stopped_s));
    }
  }
  if (judge.disobeyed_s) {
    const double budget_s =
        scenario.tick.monitors.drive.follow_time_s + scenario.tick.monitors.drive.response_s + 0.004;
    const double effect_s = seenFrom_s(*judge.disobeyed_s, scenario);
    result.reactions.push_back(react(sim::FaultKind::kDriveNotFollowing, effect_s,
                                     budget_s + putOff_s(effect_s, budget_s, scenario), result.stopped_s));
  }
  return result;
}

}  // namespace patella::bench
