#include "tools/bench/faults/scenario.hpp"

#include <cmath>
#include <numbers>

#include "tools/bench/faults/dice.hpp"

namespace patella::bench {
namespace {

using sim::FaultEvent;
using sim::FaultKind;
using sim::FrameChannel;

constexpr double kMild = 0.25;
constexpr double kComesAndGoes = 0.4;
// Room for the person's push below the limiter's kVelocityFade.
constexpr double kMotionShareOfVelocity = 0.6;

// Messages of the rig that the loop cannot do without, the command, or all.
int randomFrameChannel(Dice& dice) {
  const int drawn = dice.below(sim::kFrameChannelCount + 1);
  return drawn == sim::kFrameChannelCount ? FaultEvent::kAll : drawn;
}

double forgedValue(int channel, Dice& dice) {
  switch (static_cast<FrameChannel>(channel)) {
    case FrameChannel::kEncoder1:
    case FrameChannel::kEncoder2:
      return dice.between(-2.0, 0.1);  // rad
    case FrameChannel::kEmg:
      return dice.between(-1.5, 1.5);  // mV
    case FrameChannel::kOperator:
      return dice.below(2);
    default:
      return dice.between(-150.0, 150.0);  // N·m
  }
}

void frameFault(FaultEvent& event, bool mild, Dice& dice) {
  event.channel = randomFrameChannel(dice);
  event.probability = mild ? dice.between(0.001, 0.05) : 1.0;
  event.delay_s = mild ? dice.between(0.001, 0.003) : dice.between(0.1, 0.5);
  event.bits = 1 + dice.below(3);
  if (event.kind == FaultKind::kForgedFrames) {
    event.channel = dice.below(sim::kFrameChannelCount);
    event.value = forgedValue(event.channel, dice);
    event.counter_correct = dice.chance(0.7);
    event.crc_correct = dice.chance(0.7);
  }
}

void encoderFault(FaultEvent& event, int joints, bool mild, Dice& dice) {
  event.channel = dice.below(joints);
  switch (event.kind) {
    case FaultKind::kEncoderJump:
      event.value = dice.sign() * (mild ? dice.between(0.0, 0.01) : dice.between(0.03, 2.0));
      break;
    case FaultKind::kEncoderDrift:
      event.value = dice.sign() * (mild ? dice.between(0.0, 0.1) : dice.between(0.35, 5.0));
      break;
    case FaultKind::kEncoderWrap:
      event.value = 2.0 * std::numbers::pi;
      break;
    default:
      event.with_velocity = dice.chance(0.5);
      break;
  }
}

void emgFault(FaultEvent& event, bool mild, Dice& dice) {
  const int drawn = dice.below(kMaxEmgChannels + 1);
  event.channel = drawn == kMaxEmgChannels ? FaultEvent::kAll : drawn;
  switch (event.kind) {
    case FaultKind::kEmgSaturation:
      event.value = dice.sign() * (mild ? dice.between(0.2, 1.2) : dice.between(1.49, 1.53));
      break;
    case FaultKind::kEmgHum:
      event.value = mild ? dice.between(0.0, 0.15) : dice.between(0.6, 1.4);
      event.frequency_Hz = dice.between(49.8, 50.2);
      break;
    default:
      event.value = mild ? 0.02 : 0.0;
      break;
  }
}

// Comes and goes, from every other sample to once a second.
void cycle(FaultEvent& event, Dice& dice) {
  event.cycle_s = std::pow(10.0, dice.between(-3.0, 0.0));
  event.duty = dice.between(0.05, 0.95);
  event.duration_s = dice.between(0.9, 1.2);
}

// Between two ticks, or at any stage of one; the network's first is left out by a loop without one.
void stallSomewhere(FaultEvent& event, Dice& dice) {
  const int drawn = dice.below(static_cast<int>(tick::Stage::kOutside) + 1);
  const auto stage = static_cast<tick::Stage>(drawn - 1);
  if (drawn > 0 && stage != tick::Stage::kNetworkStep) {
    event.stage = stage;
  }
}

// Somewhere in what the leg can reach, with room to its limits.
control::JointMotion randomMotion(double middle_rad, Dice& dice) {
  return control::SinusoidMotion{.offset_rad = middle_rad + dice.between(-0.1, 0.1),
                                 .amplitude_rad = dice.between(0.05, 0.4),
                                 .frequency_Hz = dice.between(0.2, 0.7),
                                 .phase_rad = dice.between(-std::numbers::pi, std::numbers::pi)};
}

// Whether the motion alone, blend included, would bring a joint near its velocity limit: the loop would stop
// before the fault begins.
bool tooFast(const app::RunConfig& config) {
  const int joints = config.model.joints();
  control::ReferenceTrajectory reference(joints, config.tick.reference);
  JointVector start = JointVector::Zero(joints);
  for (std::size_t joint = 0; joint < config.rig.initial_q_rad.size(); ++joint) {
    start[static_cast<Eigen::Index>(joint)] = config.rig.initial_q_rad[joint];
  }
  reference.start(start);
  constexpr double kStep_s = 0.005;
  for (double t_s = 0.0; t_s < kTrialDuration_s; t_s += kStep_s) {
    const JointVector dq = reference.at(t_s).dq;
    for (int joint = 0; joint < joints; ++joint) {
      if (std::abs(dq[joint]) >
          kMotionShareOfVelocity * config.tick.limits.joint[static_cast<std::size_t>(joint)].velocity_rad_s) {
        return true;
      }
    }
  }
  return false;
}

// Two of a kind in one place are one fault, and of two on an electrode the one hides the other: what either
// owes could not be told.
bool hides(const FaultEvent& one, const FaultEvent& other) {
  const sim::ChannelGroup group = sim::channelGroup(one.kind);
  const bool share_a_channel = one.concerns(other.channel) || other.concerns(one.channel);
  const bool alike =
      one.kind == other.kind || (group == sim::ChannelGroup::kEmg && sim::channelGroup(other.kind) == group);
  return alike && share_a_channel;
}

}  // namespace

FaultEvent randomFault(FaultKind kind, int joints, Dice& dice) {
  FaultEvent event;
  event.kind = kind;
  event.time_s = dice.between(kFirstFault_s, 1.8);
  event.duration_s = dice.between(0.9, 1.2);
  const bool mild = dice.chance(kMild);
  switch (sim::channelGroup(kind)) {
    case sim::ChannelGroup::kFrames:
      frameFault(event, mild, dice);
      break;
    case sim::ChannelGroup::kEncoder:
      encoderFault(event, joints, mild, dice);
      break;
    case sim::ChannelGroup::kEmg:
      emgFault(event, mild, dice);
      break;
    case sim::ChannelGroup::kDrive:
      event.channel = dice.below(joints);
      event.value = kind == FaultKind::kDriveOverTorque
                        ? dice.sign() * (mild ? dice.between(0.0, 3.0) : dice.between(15.0, 120.0))
                        : (mild ? dice.between(0.8, 1.2) : dice.between(-1.0, 0.0));
      break;
    case sim::ChannelGroup::kNone:
      if (kind == FaultKind::kClockStep) {
        event.value = dice.sign() * std::pow(10.0, dice.between(-3.0, 4.0));
      } else if (kind == FaultKind::kGpioBounce) {
        event.value = dice.between(0.002, 0.02);
      } else if (kind != FaultKind::kEmergencyStop) {
        event.duration_s = mild ? dice.between(0.001, 0.003) : dice.between(0.03, 0.5);
      } else if (mild) {
        event.duration_s = 0.001;
      }
      break;
  }
  if (kind == FaultKind::kLoopStall) {
    stallSomewhere(event, dice);
  }
  if (kind != FaultKind::kGpioBounce && dice.chance(kComesAndGoes)) {
    cycle(event, dice);
  }
  return event;
}

void drawPatient(app::RunConfig& config, std::uint64_t seed, Dice& dice) {
  config.clock = app::ClockKind::kVirtual;
  config.duration_s = kTrialDuration_s;
  config.loop.max_ticks = static_cast<std::uint64_t>(kTrialDuration_s * config.loop.rate_Hz);
  config.rig.seed = seed;
  config.rig.interaction.human_rms_N = dice.between(0.0, 10.0);
  config.rig.interaction.human_bandwidth_Hz = dice.between(0.5, 2.0);
}

void drawOperation(app::RunConfig& config, Dice& dice) {
  config.rig.operator_buttons.enable_at_s = kEnableAt_s;
  config.rig.operator_buttons.reset_at_s.clear();
  if (dice.chance(0.3)) {
    config.rig.operator_buttons.reset_at_s = {dice.between(kFirstFault_s, kTrialDuration_s)};
  }
  do {
    config.tick.reference.blend_s = dice.between(0.5, 1.5);
    for (std::size_t joint = 0; joint < static_cast<std::size_t>(config.model.joints()); ++joint) {
      config.tick.reference.motion[joint] = randomMotion(joint % 2 == 0 ? -1.15 : -0.8, dice);
    }
  } while (tooFast(config));
}

app::RunConfig randomScenario(const app::RunConfig& base, std::uint64_t seed) {
  Dice dice(seed);
  app::RunConfig config = base;
  drawPatient(config, seed, dice);
  config.rig.drive.bandwidth_Hz = dice.chance(0.5) ? 0.0 : dice.between(60.0, 200.0);
  drawOperation(config, dice);
  const int faults = dice.chance(0.5) ? 1 : 2;
  while (static_cast<int>(config.faults.size()) < faults) {
    const FaultEvent fault =
        randomFault(static_cast<FaultKind>(dice.below(sim::kScriptedKindCount)), base.model.joints(), dice);
    if (config.faults.empty() || !hides(config.faults[0], fault)) {
      config.faults.push_back(fault);
    }
  }
  config.rig.faults = config.faults;
  return config;
}

}  // namespace patella::bench
