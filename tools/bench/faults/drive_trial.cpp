#include "tools/bench/faults/drive_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "drivers/canopen/node_setup.hpp"
#include "sim/loop_faults.hpp"
#include "tools/bench/faults/dice.hpp"
#include "tools/bench/faults/expectation.hpp"
#include "tools/bench/faults/scenario.hpp"
#include "tools/bench/faults/trial_run.hpp"

namespace patella::bench {
namespace {

using sim::FaultEvent;
using sim::FaultKind;
using sim::FrameChannel;

/// Between the effect and the sample that shows it, the tick that sees it, and its own command. A motor that
/// answers commands tells of a sample one tick later.
constexpr double kDriveMargin_s = 4e-3;
/// Beyond its range, for a leg that hangs free until its drives are in: it swings.
constexpr double kSwing_rad = 0.8;

/// What is drawn: what happens to frames, interfaces and host, and what a drive can do by itself in a run.
constexpr std::array kKinds = {FaultKind::kLostFrames,        FaultKind::kDelayedFrames,
                               FaultKind::kDuplicatedFrames,  FaultKind::kEncoderJump,
                               FaultKind::kEncoderDrift,      FaultKind::kEmgSaturation,
                               FaultKind::kEmgDisconnection,  FaultKind::kDriveNotFollowing,
                               FaultKind::kDriveOverTorque,   FaultKind::kBusOff,
                               FaultKind::kInterfaceDown,     FaultKind::kRigStall,
                               FaultKind::kPeerRestart,       FaultKind::kLoopStall,
                               FaultKind::kEmergencyStop,     FaultKind::kGpioBounce,
                               FaultKind::kDriveSilent,       FaultKind::kDriveReboots,
                               FaultKind::kDriveReportsFault, FaultKind::kDriveLeaves};

bool isCanopen(const app::RunConfig& config) {
  return config.bus.canopen.any();
}

// One drive's command as it goes over the wire, in N·m of its joint.
class CommandReader {
 public:
  CommandReader(const app::RunConfig& config, const can::CommandMap& map)
      : layout_(config.bus.database.message(map.message), {}) {
    for (const can::Binding& binding : map.bindings) {
      for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
        if (binding.input == "torque_Nm." + std::to_string(joint + 1)) {
          joint_ = joint;
          slot_ = layout_.slot(binding.signal);
          scale_ = binding.scale;
          offset_ = binding.offset;
          step_Nm_ = std::abs(scale_ * config.bus.database.message(map.message).find(binding.signal)->factor);
        }
      }
    }
    for (const auto* frames : {&map.enter, &map.leave, &map.clear}) {
      for (const can::FixedFrame& frame : *frames) {
        if (frame.message.empty()) {
          fixed_.push_back(frame.data);
        }
      }
    }
  }

  bool reads(const can::Frame& frame) const noexcept {
    return layout_.matches(frame) &&
           std::none_of(fixed_.begin(), fixed_.end(), [&frame](const std::vector<std::uint8_t>& data) {
             return std::equal(data.begin(), data.end(), frame.data.begin());
           });
  }
  std::size_t joint() const noexcept { return joint_; }
  double torque_Nm(const can::Frame& frame) const noexcept {
    return scale_ * layout_.signal(slot_).decode(frame) + offset_;
  }
  /// Of the signal: torque that is within it of zero is none.
  double step_Nm() const noexcept { return step_Nm_; }

 private:
  can::CompiledMessage layout_;
  std::vector<std::vector<std::uint8_t>> fixed_;
  std::size_t joint_ = 0;
  std::size_t slot_ = 0;
  double scale_ = 1.0, offset_ = 0.0, step_Nm_ = 0.0;
};

class DriveJudge final : public can::Bus {
 public:
  DriveJudge(can::Bus& bus, const app::RunConfig& config, const gpio::SimulatedPins& pins)
      : bus_(bus), config_(config), pins_(pins) {
    for (const can::CommandMap& command : config.bus.commands) {
      readers_.emplace_back(config, command);
    }
  }

  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    endTick();
    begin_s_ = running_ && begin_s_ < 0.0 ? static_cast<double>(now_ns - epoch_ns_) * 1e-9 : begin_s_;
    now_s_ = static_cast<double>(now_ns - epoch_ns_) * 1e-9;
    return bus_.receive(frames, now_ns);
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    const can::SendResult result = bus_.send(frame, now_ns);
    if (running_) {
      take(frame, result == can::SendResult::kSent);
    }
    return result;
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusSet downBuses() const noexcept override { return bus_.downBuses(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }
  can::BusStatistics statisticsOf(std::size_t bus) const noexcept override { return bus_.statisticsOf(bus); }

  /// Commands count from here on; instants are those of the rig, which began at `epoch_ns`.
  void begin(std::int64_t epoch_ns) noexcept {
    epoch_ns_ = epoch_ns;
    running_ = true;
  }

  /// Of the loop, from which the faults of its host count.
  double began_s() const noexcept { return begin_s_; }

  std::uint64_t violations = 0;
  std::uint64_t after_stop = 0;
  double first_active_s = -1.0;
  double stopped_s = -1.0;

 private:
  // Of several frames to a drive in one tick the last one stands: what it has to do until the next.
  void take(const can::Frame& frame, bool gone) noexcept {
    for (const CommandReader& reader : readers_) {
      if (!reader.reads(frame)) {
        continue;
      }
      const double torque_Nm = reader.torque_Nm(frame);
      const safety::JointLimits& limits = config_.tick.limits.joint[reader.joint()];
      const bool sound =
          std::isfinite(torque_Nm) && std::abs(torque_Nm) <= limits.torque_Nm + reader.step_Nm();
      violations += sound ? 0U : 1U;
      told_Nm_[reader.joint()] = gone ? torque_Nm : told_Nm_[reader.joint()];
      told_[reader.joint()] = told_[reader.joint()] || gone;
    }
  }

  void endTick() noexcept {
    if (!running_) {
      return;
    }
    bool torque = false;
    for (const CommandReader& reader : readers_) {
      const std::size_t joint = reader.joint();
      const double now_Nm = told_Nm_[joint];
      const double before_Nm = last_Nm_[joint];
      const double growth_Nm =
          now_Nm * before_Nm >= 0.0 ? std::abs(now_Nm) - std::abs(before_Nm) : std::abs(now_Nm);
      const double step_Nm =
          config_.tick.limits.joint[joint].torque_rate_Nm_s / config_.loop.rate_Hz + 2.0 * reader.step_Nm();
      violations += told_[joint] && growth_Nm > step_Nm ? 1U : 0U;
      torque = torque || (told_[joint] && std::abs(now_Nm) > reader.step_Nm());
      last_Nm_[joint] = now_Nm;
      told_[joint] = false;
    }
    const bool line = pins_.driveEnable();
    violations += torque && !line ? 1U : 0U;
    after_stop += torque && stopped_s >= 0.0 ? 1U : 0U;
    if (line && first_active_s < 0.0) {
      first_active_s = now_s_;
    }
    if (!line && !torque && first_active_s >= 0.0 && stopped_s < 0.0) {
      stopped_s = now_s_;
    }
  }

  can::Bus& bus_;
  const app::RunConfig& config_;
  const gpio::SimulatedPins& pins_;
  std::vector<CommandReader> readers_;
  bool running_ = false;
  std::int64_t epoch_ns_ = 0;
  double now_s_ = 0.0;  ///< of the tick under way
  double begin_s_ = -1.0;
  PerJoint told_Nm_{}, last_Nm_{};
  std::array<bool, kMaxJoints> told_{};  ///< in this tick
};

FaultEvent randomDriveFault(const app::RunConfig& base, Dice& dice) {
  const int canopen_kinds = isCanopen(base) ? 1 : 0;
  const int drawn = dice.below(static_cast<int>(kKinds.size()) + canopen_kinds);
  const FaultKind kind = drawn < static_cast<int>(kKinds.size()) ? kKinds[static_cast<std::size_t>(drawn)]
                                                                 : FaultKind::kDriveLosesSync;
  FaultEvent event = randomFault(kind, base.model.joints(), dice);
  if (sim::channelGroup(kind) == sim::ChannelGroup::kFrames) {
    constexpr std::array kChannels = {static_cast<int>(FrameChannel::kDriveStatus),
                                      static_cast<int>(FrameChannel::kCommand),
                                      static_cast<int>(FrameChannel::kEmg), FaultEvent::kAll};
    event.channel = kChannels[static_cast<std::size_t>(dice.below(static_cast<int>(kChannels.size())))];
  }
  if (sim::actsOnBus(kind) && base.buses.size() > 1 && dice.chance(0.5)) {
    event.bus = dice.below(static_cast<int>(base.buses.size()));
  }
  if (sim::needsFieldDrive(kind) && dice.chance(0.5)) {
    event.duration_s = dice.between(0.001, 0.2);
  }
  return event;
}

// A drive of which nothing is heard for so long.
std::optional<double> silentFor(const app::RunConfig& scenario, double effect_s, double duration_s) {
  const double timeout_s = scenario.bus.map.encoder_timeout_s;
  return duration_s > timeout_s + kDriveMargin_s ? std::optional(effect_s + timeout_s + kDriveMargin_s)
                                                 : std::nullopt;
}

double slowestHeartbeat_s(const app::RunConfig& scenario) {
  double slowest_s = 0.0;
  for (const sim::FieldDriveOptions& drive : scenario.rig.field_drives) {
    slowest_s =
        std::max(slowest_s, drive.kind == sim::FieldDriveKind::kOdrive ? drive.heartbeat_period_s : 0.0);
  }
  return slowest_s;
}

// A drive's own report of its state: an ODrive's comes with its heartbeat, a motor in MIT mode has none.
std::optional<double> reported(const app::RunConfig& scenario, const FaultEvent& event) {
  const sim::FieldDriveKind kind = scenario.rig.field_drives[static_cast<std::size_t>(event.channel)].kind;
  const double wait_s = kind == sim::FieldDriveKind::kOdrive ? slowestHeartbeat_s(scenario) : 0.0;
  const bool told = kind != sim::FieldDriveKind::kMit || event.kind == FaultKind::kDriveReportsFault;
  return told && event.duration_s > wait_s + kDriveMargin_s
             ? std::optional(event.time_s + wait_s + kDriveMargin_s)
             : std::nullopt;
}

}  // namespace

std::optional<double> owedByDrives_s(const app::RunConfig& scenario) {
  const FaultEvent& event = scenario.faults.front();
  const double effect_s = event.time_s;
  if (scenario.faults.size() > 1 || event.cycle_s > 0.0 || event.probability < 1.0) {
    return std::nullopt;
  }
  const bool drives =
      event.channel == FaultEvent::kAll || event.channel == static_cast<int>(FrameChannel::kDriveStatus);
  switch (event.kind) {
    case FaultKind::kBusOff:
    case FaultKind::kInterfaceDown:
    case FaultKind::kEmergencyStop:
    case FaultKind::kGpioBounce:
    case FaultKind::kEmgSaturation:
    case FaultKind::kEmgDisconnection: {
      const auto owed_s = owedStop_s(scenario.faults, 0, effect_s, scenario);
      return owed_s ? std::optional(*owed_s + kDriveMargin_s) : std::nullopt;
    }
    case FaultKind::kLostFrames:
      return drives ? silentFor(scenario, effect_s, event.duration_s) : std::nullopt;
    case FaultKind::kDelayedFrames:
      return drives ? silentFor(scenario, effect_s, std::min(event.delay_s, event.duration_s)) : std::nullopt;
    case FaultKind::kRigStall:
    case FaultKind::kPeerRestart:
    case FaultKind::kDriveSilent:
    case FaultKind::kDriveReboots:
    case FaultKind::kDriveLosesSync:
      return silentFor(scenario, effect_s, event.duration_s);
    case FaultKind::kDriveReportsFault:
    case FaultKind::kDriveLeaves:
      return reported(scenario, event);
    default:
      return std::nullopt;
  }
}

app::RunConfig randomDriveScenario(const app::RunConfig& base, std::uint64_t seed) {
  Dice dice(seed);
  app::RunConfig config = base;
  drawPatient(config, seed, dice);
  drawOperation(config, dice);
  for (safety::JointLimits& limits : config.tick.limits.joint) {
    limits.q_min_rad -= kSwing_rad;
    limits.q_max_rad += kSwing_rad;
  }
  config.faults = {randomDriveFault(base, dice)};
  if (dice.chance(1.0 / 3.0)) {
    config.faults.push_back(randomDriveFault(base, dice));
  }
  config.rig.faults = config.faults;
  return config;
}

TrialResult runDriveTrial(const app::RunConfig& scenario, std::uint64_t seed) {
  TrialRun<DriveJudge> run(scenario);
  DriveJudge& judge = run.judge;
  const std::int64_t epoch_ns = run.clock.now();
  if (isCanopen(scenario)) {
    canopen::setUpNodes(judge, run.clock, scenario.bus.canopen, 1.0 / scenario.loop.rate_Hz);
  }
  judge.begin(epoch_ns);
  TrialResult result = run.result(seed);
  result.unlatched = judge.after_stop;
  const auto owed_s = owedByDrives_s(scenario);
  if (owed_s && *owed_s < kTrialDuration_s - 5e-3) {
    const FaultEvent& event = scenario.faults.front();
    const double effect_s = event.time_s + (sim::actsOnLoop(event.kind) ? judge.began_s() : 0.0);
    const double budget_s = *owed_s - event.time_s;
    const double taken_s = result.stopped_s >= 0.0 ? result.stopped_s - effect_s : kTrialDuration_s;
    result.reactions.push_back({event.kind, effect_s, budget_s, taken_s, taken_s > budget_s + 1e-9});
  }
  return result;
}

}  // namespace patella::bench
