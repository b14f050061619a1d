#include "tools/bench/faults/expectation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/safety/encoder_monitor.hpp"
#include "core/safety/leaky_score.hpp"
#include "drivers/can/bad_frames.hpp"
#include "tools/bench/faults/scenario.hpp"
#include "tools/bench/faults/sight.hpp"
#include "tools/bench/faults/stall_schedule.hpp"

namespace patella::bench {
namespace {

using sim::FaultEvent;
using sim::FaultKind;
using sim::FrameChannel;

constexpr double kSample_s = 1e-3;
/// Between the effect and the tick that sees it, and its own.
constexpr double kMargin_s = 2.0 * kSample_s;
/// A condition that lasts but a sample longer than tolerated may be judged either way.
constexpr double kUncertain_s = 2.0 * kSample_s;

std::optional<double> earlier(std::optional<double> one, std::optional<double> other) {
  return one && other ? std::min(*one, *other) : one ? one : other;
}
std::optional<double> after(std::optional<double> instant_s, double span_s) {
  return instant_s ? std::optional(*instant_s + span_s) : std::nullopt;
}

double framePeriod_s(FrameChannel channel) {
  return channel == FrameChannel::kOperator ? 10.0 * kSample_s : kSample_s;
}

// Silence of a channel until its age is beyond the timeout.
std::optional<double> silence(const Sight& sight, double timeout_s, double period_s, double longest_s) {
  double age_s = period_s;
  double since_s = 0.0;
  double burst_s = -1.0;
  const auto found = sight.walk(kSample_s, [&](double t, bool there, bool) {
    // Frames that are held back come at the end of each burst, however soon the next one begins.
    const bool held =
        sight.event().kind == FaultKind::kRigStall || sight.event().kind == FaultKind::kDelayedFrames;
    const bool next = std::exchange(burst_s, sight.event().burstStart(t)) != sight.event().burstStart(t);
    const bool released = held && next;
    since_s = there && !released ? since_s + kSample_s : 0.0;
    age_s = there && !released && since_s <= longest_s ? age_s + kSample_s : period_s;
    return age_s > timeout_s + kUncertain_s;
  });
  return after(found, kMargin_s);
}

std::optional<double> silenceOf(const Sight& sight, FrameChannel channel, const app::RunConfig& config,
                                double longest_s) {
  const can::BusMap& map = config.bus.map;
  const auto owed = [&](double timeout_s) {
    return silence(sight, timeout_s, framePeriod_s(channel), longest_s);
  };
  switch (channel) {
    case FrameChannel::kEncoder1:
    case FrameChannel::kEncoder2:
      return owed(map.encoder_timeout_s);
    case FrameChannel::kDriveStatus:
      return owed(map.drive_timeout_s);
    case FrameChannel::kEmg:
      return owed(map.emg_timeout_s);
    case FrameChannel::kOperator:
      return owed(map.operator_timeout_s);
    case FrameChannel::kCommand:
      return after(owed(config.rig.drive.watchdog_s), kMargin_s);
    default:
      return std::nullopt;
  }
}

// Frames of one channel that are bad in a row, or too often: `frames(there)` says of each sample how many
// good and bad frames it brings, in the order of what comes.
struct FramesOfASample {
  int good_before = 0;
  int bad = 0;
  int good_after = 0;
};
template <typename Frames>
std::optional<double> badFrames(const Sight& sight, double period_s, int tolerated, Frames&& frames) {
  can::BadFrames count;
  const auto found = sight.walk(period_s, [&](double, bool there, bool heard) {
    const FramesOfASample sample = frames(there);
    if (!heard) {
      return false;
    }
    for (int i = 0; i < sample.good_before; ++i) {
      count.count(false, tolerated + 1);
    }
    for (int i = 0; i < sample.bad; ++i) {
      count.count(true, tolerated + 1);
    }
    for (int i = 0; i < sample.good_after; ++i) {
      count.count(false, tolerated + 1);
    }
    return count.tooMany(tolerated +
                         1);  // one more than the loop tolerates: where the first falls is uncertain
  });
  return after(found, kMargin_s + period_s);
}

// An error of three bits passes the CRC once in 210 (unit/can/crc8_test.cpp): as many frames more as make two
// passes in a row of them rarer than one in a million.
int toleratedFlips(const FaultEvent& event, int tolerated) {
  constexpr int kCrcDetects = 2;
  return event.bits > kCrcDetects ? 3 * (tolerated + 1) : tolerated;
}

std::optional<double> framesOf(const Sight& sight, FrameChannel channel, const app::RunConfig& config) {
  const FaultEvent& event = sight.event();
  const int tolerated = config.bus.map.tolerated_bad_frames;
  const double period_s = framePeriod_s(channel);
  bool waiting = false;
  switch (event.kind) {
    case FaultKind::kLostFrames:
      return silenceOf(sight, channel, config, event.duration_s);
    case FaultKind::kDelayedFrames:
      return silenceOf(sight, channel, config, event.delay_s);
    case FaultKind::kFlippedBits:
      return badFrames(sight, period_s, toleratedFlips(event, tolerated),
                       [](bool there) { return FramesOfASample{.bad = there, .good_after = !there}; });
    case FaultKind::kReorderedFrames:
      return badFrames(sight, period_s, tolerated, [&](bool there) {
        const bool both = waiting;
        waiting = !both && there;
        return FramesOfASample{.bad = both ? 2 : 0, .good_after = both || waiting ? 0 : 1};
      });
    case FaultKind::kDuplicatedFrames:
    case FaultKind::kForgedFrames:
      return badFrames(sight, period_s, tolerated,
                       [](bool there) { return FramesOfASample{.good_before = 1, .bad = there}; });
    default:
      return std::nullopt;
  }
}

// Commands are not heard by the loop, but for those that somebody else sends; what becomes of its own shows
// in the drives' watchdog and report.
std::optional<double> commandsOf(const Sight& sight, double effect_s, const app::RunConfig& config) {
  const FaultEvent& event = sight.event();
  switch (event.kind) {
    case FaultKind::kForgedFrames:
      return effect_s + kMargin_s;
    case FaultKind::kLostFrames:
      return silenceOf(sight, FrameChannel::kCommand, config, event.duration_s);
    case FaultKind::kDelayedFrames:
      return silenceOf(sight, FrameChannel::kCommand, config, event.delay_s);
    case FaultKind::kFlippedBits: {
      // A command that passes the CRC restarts the drives' watchdog: six times in a row once in five million.
      constexpr double kRestarts = 6.0;
      const bool passes = toleratedFlips(event, 0) > 0;
      return after(silenceOf(sight, FrameChannel::kCommand, config, event.duration_s),
                   passes ? kRestarts * config.rig.drive.watchdog_s : 0.0);
    }
    default:
      return std::nullopt;
  }
}

std::optional<double> framesOwed(const Sight& sight, double effect_s, const app::RunConfig& config) {
  const FaultEvent& event = sight.event();
  if (event.probability < 1.0) {
    return std::nullopt;
  }
  std::optional<double> owed;
  for (int i = 0; i < sim::kFrameChannelCount; ++i) {
    const auto channel = static_cast<FrameChannel>(i);
    if (!event.concerns(i) || channel == FrameChannel::kTruth) {
      continue;
    }
    owed = earlier(owed, channel == FrameChannel::kCommand ? commandsOf(sight, effect_s, config)
                                                           : framesOf(sight, channel, config));
  }
  return owed;
}

// A position that is off: too far for one sample, and refused, or taken and inconsistent with the rate.
std::optional<double> jumpOwed(const Sight& sight, const app::RunConfig& config) {
  if (std::abs(sight.event().value) < 1.5 * config.tick.monitors.encoder.inconsistency_rad) {
    return std::nullopt;
  }
  return badFrames(sight, kSample_s, config.bus.map.tolerated_bad_frames,
                   [](bool there) { return FramesOfASample{.bad = there, .good_after = !there}; });
}

// r_k = e^{−dt/T} r_{k−1} + what the drift adds, until it is a quarter above the limit for what noise may
// take off.
std::optional<double> driftOwed(const Sight& sight, const app::RunConfig& config) {
  const safety::EncoderMonitorSettings& encoder = config.tick.monitors.encoder;
  double residual_rad = 0.0;
  double offset_rad = 0.0;
  double step_s = 0.0;
  const auto found = sight.walk(kSample_s, [&](double t, bool there, bool heard) {
    step_s += kSample_s;
    if (!heard) {
      return false;
    }
    const double next_rad = there ? sight.event().value * (t - sight.event().burstStart(t)) : 0.0;
    // After a silence position and rate are compared anew.
    const bool anew = step_s > safety::EncoderMonitor::kMaxStep_s;
    residual_rad =
        anew ? 0.0 : std::exp(-step_s / encoder.consistency_time_s) * residual_rad + next_rad - offset_rad;
    offset_rad = next_rad;
    step_s = 0.0;
    return std::abs(residual_rad) > 1.25 * encoder.inconsistency_rad;
  });
  // A drift that ends is a jump back, which may be refused at first.
  return after(found, kMargin_s + (config.bus.map.tolerated_bad_frames + 1) * kSample_s);
}

// For how long a condition of an EMG signal may hold, in all.
template <typename Bad>
std::optional<double> emgOwed(const Sight& sight, double longest_s, Bad&& bad) {
  safety::LeakyScore score(longest_s + kUncertain_s);
  const auto found = sight.walk(kSample_s, [&](double t, bool there, bool heard) {
    return heard && score.update(bad(t, there), kSample_s);
  });
  return after(found, kMargin_s);
}

std::optional<double> disconnectionOwed(const Sight& sight, const safety::EmgMonitorSettings& emg) {
  if (sight.event().value != 0.0 || emg.flat_mV == 0.0) {
    return std::nullopt;
  }
  constexpr double kStill_s = 0.02;
  double still_s = 0.0;
  return emgOwed(sight, emg.flat_time_s - kStill_s, [&](double, bool there) {
    still_s = there ? still_s + kSample_s : 0.0;
    return still_s > kStill_s + kUncertain_s;
  });
}

std::optional<double> humOwed(const Sight& sight, const app::RunConfig& config) {
  constexpr double kFilter_s = 0.1;
  constexpr double kMuscleHides = 1.3;  // of the limit: EMG may take off as much
  const safety::EmgMonitorSettings& emg = config.tick.monitors.emg;
  const FaultEvent& event = sight.event();
  // Of unknown mains the larger hum counts: what either owes is owed.
  const double known_Hz = config.tick.emg.mains_Hz;
  struct Mixer {
    double rad_s = 0.0;
    double real_mV = 0.0;
    double imaginary_mV = 0.0;
  };
  std::array<Mixer, 2> mixers;
  mixers[0].rad_s = 2.0 * std::numbers::pi * (known_Hz > 0.0 ? known_Hz : 50.0);
  mixers[1].rad_s = 2.0 * std::numbers::pi * (known_Hz > 0.0 ? known_Hz : 60.0);
  return emgOwed(sight, emg.hum_time_s, [&](double t, bool there) {
    const double signal_mV =
        there ? event.value * std::sin(2.0 * std::numbers::pi * event.frequency_Hz * t) : 0.0;
    const double share = kSample_s / kFilter_s;
    bool bad = false;
    for (Mixer& mixer : mixers) {
      mixer.real_mV += share * (signal_mV * std::cos(mixer.rad_s * t) - mixer.real_mV);
      mixer.imaginary_mV += share * (signal_mV * std::sin(mixer.rad_s * t) - mixer.imaginary_mV);
      bad = bad || 2.0 * std::hypot(mixer.real_mV, mixer.imaginary_mV) > kMuscleHides * emg.hum_mV;
    }
    return bad;
  });
}

// So far off that no span of commands covers it; what is less is judged by Trial, which knows the commands.
std::optional<double> overTorqueOwed(const Sight& sight, const app::RunConfig& config) {
  constexpr double kSpan_Nm = 20.0;
  const FaultEvent& event = sight.event();
  const safety::DriveMonitorSettings& drive = config.tick.monitors.drive;
  const double limit_Nm = config.tick.limits.joint[static_cast<std::size_t>(event.channel)].torque_Nm;
  if (std::abs(event.value) < 3.0 * drive.follow_tolerance * limit_Nm + kSpan_Nm) {
    return std::nullopt;
  }
  safety::LeakyScore score(drive.follow_time_s + kUncertain_s, safety::kDriveRecovery);
  const auto found = sight.walk(
      kSample_s, [&](double, bool there, bool heard) { return heard && score.update(there, kSample_s); });
  return after(found, kMargin_s);
}

}  // namespace

std::optional<double> owedStop_s(const std::vector<FaultEvent>& faults, std::size_t index, double effect_s,
                                 const app::RunConfig& config) {
  const Sight sight(faults, index, effect_s);
  const FaultEvent& event = sight.event();
  const safety::EmgMonitorSettings& emg = config.tick.monitors.emg;
  switch (event.kind) {
    case FaultKind::kEncoderJump:
    case FaultKind::kEncoderWrap:
      return jumpOwed(sight, config);
    case FaultKind::kEncoderDrift:
      return driftOwed(sight, config);
    case FaultKind::kEmgSaturation:
      return std::abs(event.value) > emg.saturation_mV + 0.01
                 ? emgOwed(sight, emg.saturation_time_s, [](double, bool there) { return there; })
                 : std::nullopt;
    case FaultKind::kEmgDisconnection:
      return disconnectionOwed(sight, emg);
    case FaultKind::kEmgHum:
      return humOwed(sight, config);
    case FaultKind::kDriveOverTorque:
      return overTorqueOwed(sight, config);
    case FaultKind::kBusOff:
    case FaultKind::kInterfaceDown:
    case FaultKind::kEmergencyStop:
    case FaultKind::kGpioBounce:
      return effect_s + kMargin_s;
    case FaultKind::kRigStall:
    case FaultKind::kPeerRestart:
      return silenceOf(sight, FrameChannel::kEncoder1, config, event.duration_s);
    case FaultKind::kLoopStall: {
      const auto consequence = stallConsequence(event, config);
      return consequence ? consequence->stop_s : std::nullopt;
    }
    default:
      return framesOwed(sight, effect_s, config);
  }
}

}  // namespace patella::bench
