#include "tools/bench/faults/trial.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/safety/leaky_score.hpp"
#include "sim/loop_faults.hpp"
#include "tools/bench/faults/expectation.hpp"
#include "tools/bench/faults/scenario.hpp"
#include "tools/bench/faults/stall_schedule.hpp"
#include "tools/bench/faults/trial_run.hpp"

namespace patella::bench {
namespace {

/// A command may round to the bus's resolution and back.
constexpr double kResolution_Nm = 0.0006;

// Reads every command that the loop sends, as the drives would, and holds it against the limits.
class Judge final : public can::Bus {
 public:
  Judge(can::Bus& bus, const app::RunConfig& config, const gpio::SimulatedPins& pins)
      : bus_(bus),
        config_(config),
        pins_(pins),
        decoder_(app::makeDecoder(config)),
        command_(config.bus.database.message("TorqueCommand")),
        oldest_ns_(std::llround(1e9 * (config.bus.map.encoder_timeout_s + 1.0 / config.loop.rate_Hz))),
        told_(
            static_cast<std::size_t>(std::ceil(config.tick.monitors.drive.response_s * config.loop.rate_Hz)) +
            1),
        astray_(config.tick.monitors.drive.follow_time_s + 2.0 / config.loop.rate_Hz,
                safety::kDriveRecovery) {
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
    // State after the tick before: the line must not be up without an enabling command.
    violations += pins_.driveEnable() && !enabled_ ? 1U : 0U;
    const std::size_t count = bus_.receive(frames, now_ns);
    for (std::size_t i = 0; i < count; ++i) {
      decoder_.accept(frames[i]);
    }
    const Measurement measurement = decoder_.finish(now_ns).measurement;
    measured_ns_ = measurement.encoder_monotonic_ns;
    judgeDrives(measurement, now_ns);
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    judge(frame, now_ns);
    return bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

  std::uint64_t violations = 0;
  std::uint64_t enabled_after_fault = 0;
  double first_active_s = -1.0;
  double stopped_s = -1.0;
  /// The drives did not do what they were told, from when on, and for too long when.
  struct Disobedience {
    double since_s = 0.0;
    double owed_s = 0.0;
  };
  std::optional<Disobedience> disobeyed;

 private:
  static constexpr std::size_t kJoints = 2;

  double seconds(std::int64_t now_ns) const { return static_cast<double>(now_ns - epoch_ns_) * 1e-9; }

  void judge(const can::Frame& frame, std::int64_t now_ns) noexcept {
    const double time_s = seconds(now_ns);
    const bool enable = command_.signal(enable_).decode(frame) > 0.5;
    std::array<double, kJoints>& told_Nm = told_[next_told_];
    next_told_ = (next_told_ + 1) % told_.size();
    const auto state = static_cast<safety::State>(static_cast<int>(command_.signal(state_).decode(frame)));
    bool sound = enable == (state == safety::State::kActive);
    // Torque follows from a measurement that is not too old when it goes out.
    sound = sound && (!enable || now_ns - measured_ns_ <= oldest_ns_);
    for (std::size_t j = 0; j < torque_.size(); ++j) {
      const double torque_Nm = command_.signal(torque_[j]).decode(frame);
      const safety::JointLimits& limits = config_.tick.limits.joint[j];
      const double growth_Nm =
          torque_Nm * last_Nm_[j] >= 0.0 ? std::abs(torque_Nm) - std::abs(last_Nm_[j]) : std::abs(torque_Nm);
      sound = sound && std::isfinite(torque_Nm) && std::abs(torque_Nm) <= limits.torque_Nm + kResolution_Nm &&
              growth_Nm <= limits.torque_rate_Nm_s / config_.loop.rate_Hz + kResolution_Nm &&
              (enable || torque_Nm == 0.0);
      last_Nm_[j] = torque_Nm;
      told_Nm[j] = enable ? torque_Nm : 0.0;
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

  // docs/safety.md: a report outside of the span of the commands of the last response_s, widened by the
  // tolerance, counts by its share of the time. A command that allowed no torque stands for zero.
  void judgeDrives(const Measurement& measurement, std::int64_t now_ns) noexcept {
    constexpr double kUncertain_Nm = 0.1;
    bool astray = false;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double tolerance_Nm =
          config_.tick.monitors.drive.follow_tolerance * config_.tick.limits.joint[j].torque_Nm +
          kUncertain_Nm;
      double lowest_Nm = told_[0][j];
      double highest_Nm = told_[0][j];
      for (const auto& told : told_) {
        lowest_Nm = std::min(lowest_Nm, told[j]);
        highest_Nm = std::max(highest_Nm, told[j]);
      }
      const double reported_Nm = measurement.drive_torque_Nm[static_cast<Eigen::Index>(j)];
      astray = astray || reported_Nm < lowest_Nm - tolerance_Nm || reported_Nm > highest_Nm + tolerance_Nm;
    }
    if (first_active_s < 0.0) {
      return;
    }
    if (astray && !astray_since_s_) {
      astray_since_s_ = seconds(now_ns);
    }
    if (astray_.update(astray, 1.0 / config_.loop.rate_Hz) && !disobeyed) {
      disobeyed = Disobedience{*astray_since_s_, seconds(now_ns)};
    }
  }

  can::Bus& bus_;
  const app::RunConfig& config_;
  const gpio::SimulatedPins& pins_;
  can::MeasurementDecoder decoder_;  ///< what the loop is told
  can::MessageDecoder command_;
  std::int64_t oldest_ns_;
  std::vector<std::array<double, kJoints>> told_;  ///< the newest commands, as a ring
  std::size_t next_told_ = 0;
  safety::LeakyScore astray_;
  std::int64_t measured_ns_ = 0;
  std::array<std::size_t, kJoints> torque_{};
  std::size_t enable_ = 0;
  std::size_t state_ = 0;
  bool started_ = false;
  std::int64_t epoch_ns_ = 0;
  std::array<double, kJoints> last_Nm_{};
  bool enabled_ = false;
  bool fault_seen_ = false;
  std::optional<double> astray_since_s_;
};

// When each fault of the scenario first did something; negative where it never did.
std::vector<double> effects_s(const app::RunConfig& scenario, const sim::Rig& rig) {
  std::vector<double> effects;
  std::size_t of_rig = 0;
  for (const sim::FaultEvent& event : scenario.faults) {
    if (event.kind == sim::FaultKind::kLoopStall) {
      const auto consequence = stallConsequence(event, scenario);
      effects.push_back(consequence ? consequence->effect_s : -1.0);
    } else if (sim::actsOnLoop(event.kind) && event.kind != sim::FaultKind::kClockStep) {
      effects.push_back(event.time_s);
    } else {
      effects.push_back(rig.faults().firstEffects_s().at(of_rig++));
    }
  }
  return effects;
}

// A loop that stands still can do nothing: what is owed is put off by each stall that comes before it, its
// own that of a stall excepted.
double putOff(double owed_s, double effect_s, const sim::FaultEvent* own, const app::RunConfig& scenario) {
  for (const sim::FaultEvent& event : scenario.faults) {
    if (event.kind != sim::FaultKind::kLoopStall || &event == own) {
      continue;
    }
    double from_s = std::max(effect_s, event.time_s);
    while (from_s <= owed_s && from_s < event.time_s + event.duration_s) {
      const double end_s = event.burstEnd(from_s);
      owed_s += std::max(end_s - from_s, 0.0) + 1e-3;
      from_s = event.cycle_s > 0.0 ? event.burstStart(from_s) + event.cycle_s * (1.0 + 1e-9)
                                   : event.time_s + event.duration_s;
    }
  }
  return owed_s;
}

Reaction react(sim::FaultKind kind, double effect_s, double owed_s, double stopped_s) {
  const bool stopped = stopped_s >= 0.0;
  return {kind, effect_s, owed_s - effect_s, stopped ? stopped_s - effect_s : kTrialDuration_s,
          !stopped || stopped_s > owed_s + 1e-9};
}

// Whatever the drives did, it is put down to their own fault, where the scenario has one.
sim::FaultKind disobedienceKind(const app::RunConfig& scenario) {
  for (const sim::FaultEvent& event : scenario.faults) {
    if (sim::channelGroup(event.kind) == sim::ChannelGroup::kDrive) {
      return event.kind;
    }
  }
  return sim::FaultKind::kDriveNotFollowing;
}

std::vector<Reaction> reactions(const app::RunConfig& scenario, const sim::Rig& rig, const Judge& judge,
                                double stopped_s) {
  std::vector<Reaction> found;
  const std::vector<double> effects = effects_s(scenario, rig);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (effects[i] < 0.0) {
      continue;
    }
    const sim::FaultEvent& event = scenario.faults[i];
    if (const auto owed_s = owedStop_s(scenario.faults, i, effects[i], scenario)) {
      found.push_back(
          react(event.kind, effects[i], putOff(*owed_s, effects[i], &event, scenario), stopped_s));
    }
  }
  if (judge.disobeyed && (stopped_s < 0.0 || judge.disobeyed->since_s <= stopped_s)) {
    const auto& [since_s, owed_s] = *judge.disobeyed;
    found.push_back(react(disobedienceKind(scenario), since_s,
                          putOff(owed_s + 2e-3, since_s, nullptr, scenario), stopped_s));
  }
  // Stops owed after the end of the run are not judged.
  std::erase_if(found, [](const Reaction& r) { return r.effect_s + r.budget_s > kTrialDuration_s - 5e-3; });
  return found;
}

}  // namespace

TrialResult runTrial(const app::RunConfig& scenario, std::uint64_t seed) {
  TrialRun<Judge> run(scenario);
  TrialResult result = run.result(seed);
  result.unlatched = run.judge.enabled_after_fault;
  result.reactions = reactions(scenario, *run.rig, run.judge, result.stopped_s);
  return result;
}

}  // namespace patella::bench
