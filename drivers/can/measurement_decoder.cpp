#include "drivers/can/measurement_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/can/elapsed_periods.hpp"

namespace patella::can {

bool MeasurementDecoder::isBound(Input input, std::size_t index) const noexcept {
  return bound_[static_cast<std::size_t>(input)][index];
}

void MeasurementDecoder::accept(const Frame& frame) noexcept {
  if (frame.own || frame.error || frame.remote)
    return;
  const auto found = std::find_if(messages_.begin(), messages_.end(), [&](const BoundMessage& candidate) {
    return candidate.decoder.matches(frame);
  });
  if (found == messages_.end()) {
    ++unknown_frames_;
    return;
  }
  BoundMessage& message = *found;
  ++message.statistics.received;
  if (!followSequence(message, frame))
    return;
  Values values;
  if (!readValues(message, frame, values)) {
    ++message.statistics.out_of_range;
    message.implausible.count(true, tolerated_);
    return;
  }
  message.implausible.count(false, tolerated_);
  store(message, frame, values);
}

bool MeasurementDecoder::followSequence(BoundMessage& message, const Frame& frame) noexcept {
  const FrameCheck check = message.decoder.check(frame, mostSteps(message, frame));
  const bool corrupt = check.status == FrameStatus::kCorrupt || check.status == FrameStatus::kTooShort;
  message.corrupt.count(corrupt, tolerated_);
  if (corrupt) {
    ++message.statistics.corrupt;
    return false;
  }
  const bool in_order = check.sequence == Sequence::kFirst || check.sequence == Sequence::kNew;
  message.sequence.count(!in_order, tolerated_);
  if (check.status == FrameStatus::kRepeated) {
    ++message.statistics.repeated;
    return false;
  }
  if (check.status == FrameStatus::kOutOfOrder) {
    ++message.statistics.reordered;
    return false;
  }
  std::int64_t steps = check.steps;
  if (message.started && message.period_ns > 0) {
    const std::int64_t elapsed =
        elapsedPeriods(frame.wall_ns - message.last_wall_ns, frame.monotonic_ns - message.last_monotonic_ns,
                       message.period_ns);
    // Whole turns of the counter during a long silence show only on the clock.
    const std::int64_t modulus = message.decoder.counterModulus();
    if (message.decoder.hasCounter() && elapsed > steps)
      steps += roundedRatio(elapsed - steps, modulus) * modulus;
  }
  if (message.decoder.hasCounter())
    message.statistics.lost += static_cast<std::uint64_t>(steps - 1);
  message.sample += steps;
  message.started = true;
  message.last_wall_ns = frame.wall_ns;
  message.last_monotonic_ns = frame.monotonic_ns;
  return true;
}

// How far the counter may have gone on since the last frame that was in order. Whatever it shows after a
// silence as long as the timeout is a new beginning: the sender may have been switched off and on.
int MeasurementDecoder::mostSteps(const BoundMessage& message, const Frame& frame) const noexcept {
  constexpr std::int64_t kSlack = 3;  // frames that come in a bunch
  const int modulus = message.decoder.counterModulus();
  const std::int64_t silence_ns = frame.monotonic_ns - message.last_monotonic_ns;
  if (!message.started || silence_ns > message.timeout_ns)
    return modulus;
  if (message.period_ns == 0)
    return modulus / 2;
  const std::int64_t elapsed =
      elapsedPeriods(frame.wall_ns - message.last_wall_ns, silence_ns, message.period_ns);
  return static_cast<int>(std::min<std::int64_t>(elapsed + kSlack, modulus));
}

bool MeasurementDecoder::readValues(const BoundMessage& message, const Frame& frame,
                                    Values& values) const noexcept {
  for (std::size_t i = 0; i < message.inputs.size(); ++i) {
    const BoundInput& input = message.inputs[i];
    const CompiledSignal& signal = message.decoder.signal(input.slot);
    const double physical = signal.decode(frame);
    values[i] = physical * input.scale + input.offset;
    if (signal.presence(frame) == Presence::kNotSelected)
      continue;
    if (!signal.inRange(physical)) {
      if (kInputKinds[static_cast<std::size_t>(input.input)].group != kNoTimeout)
        return false;
      // What is only recorded says nothing of the others.
      values[i] = std::numeric_limits<double>::quiet_NaN();
    }
    if (input.input == Input::kPosition && !plausiblePosition(message, frame, input, values[i]))
      return false;
  }
  return true;
}

// Sensor periods since the input's sample before. Without a counter the input's own frames tell: those of a
// multiplexed message take turns, and a drive may answer twice within a period.
std::int64_t MeasurementDecoder::periodsSince(const BoundMessage& message, const Frame& frame,
                                              const BoundInput& input) const noexcept {
  const Sample& before = samples_[static_cast<std::size_t>(input.input)][input.index];
  if (message.decoder.hasCounter())
    return message.sample - before.number;
  return elapsedPeriods(frame.wall_ns - before.wall_ns, frame.monotonic_ns - before.monotonic_ns,
                        message.period_ns);
}

bool MeasurementDecoder::plausiblePosition(const BoundMessage& message, const Frame& frame,
                                           const BoundInput& input, double position_rad) const noexcept {
  constexpr auto kPosition = static_cast<std::size_t>(Input::kPosition);
  if (position_rad < position_min_rad_ || position_rad > position_max_rad_)
    return false;
  const std::size_t joint = input.index;
  const bool has_reference =
      seen_[kPosition][joint] && frame.monotonic_ns - stored_ns_[kPosition][joint] <= message.timeout_ns;
  if (!has_reference)
    return true;
  const auto steps = static_cast<double>(periodsSince(message, frame, input));
  const double jump = position_rad - measurement_.position_rad[static_cast<Eigen::Index>(joint)];
  return std::abs(jump) <= position_jump_rad_ * std::max(steps, 1.0);
}

void MeasurementDecoder::store(BoundMessage& message, const Frame& frame, const Values& values) noexcept {
  if (message.used && frame.monotonic_ns - message.used_monotonic_ns > message.timeout_ns) {
    ++message.statistics.late;
  }
  message.used = true;
  message.used_monotonic_ns = frame.monotonic_ns;
  for (std::size_t i = 0; i < message.inputs.size(); ++i) {
    const BoundInput& input = message.inputs[i];
    if (message.decoder.signal(input.slot).presence(frame) == Presence::kNotSelected)
      continue;
    storeInput(message, frame, input, values[i]);
    seen_[static_cast<std::size_t>(input.input)][input.index] = true;
    stored_ns_[static_cast<std::size_t>(input.input)][input.index] = frame.monotonic_ns;
    if (input.input == Input::kPosition) {
      arrived_ns_[input.index] = frame.monotonic_ns - frame.age_ns;
      measurement_.encoder_wall_ns = frame.wall_ns;
    }
  }
}

// Takes note of a position or an EMG sample. False for one that no period separates from the one before: its
// value counts, but it is no sample of its own.
bool MeasurementDecoder::nextSample(const BoundMessage& message, const Frame& frame,
                                    const BoundInput& input) noexcept {
  Sample& sample = samples_[static_cast<std::size_t>(input.input)][input.index];
  const bool first = !seen_[static_cast<std::size_t>(input.input)][input.index];
  const std::int64_t steps = first ? message.sample : periodsSince(message, frame, input);
  if (steps == 0)
    return false;
  sample = {sample.number + steps, frame.wall_ns, frame.monotonic_ns};
  return true;
}

bool MeasurementDecoder::judge(const BoundInput& input, double value) noexcept {
  if (input.mask != 0)
    value = static_cast<double>(static_cast<std::uint64_t>(std::max(value, 0.0)) & input.mask);
  if (!input.good.empty())
    return std::find(input.good.begin(), input.good.end(), value) != input.good.end();
  const bool enabled = input.input == Input::kDriveEnabled || input.input == Input::kJointEnabled;
  return enabled ? value > 0.5 : value == 0.0;
}

void MeasurementDecoder::storeInput(const BoundMessage& message, const Frame& frame, const BoundInput& input,
                                    double value) noexcept {
  const Eigen::Index index = input.index;
  switch (input.input) {
    case Input::kPosition:
      measurement_.position_rad[index] = value;
      if (nextSample(message, frame, input))
        encoder_samples_.add(input.index, sampleNumber(input));
      break;
    case Input::kVelocity:
      measurement_.velocity_rad_s[index] = value;
      break;
    case Input::kDriveTorque:
      drive_reports_.torque(index, value);
      break;
    case Input::kEmg:
      measurement_.emg_mV[input.index] = value;
      if (nextSample(message, frame, input))
        emg_samples_.add(input.index, sampleNumber(input));
      break;
    case Input::kTruth:
      if (std::isnan(value))
        break;
      measurement_.true_f_u[index] = value;
      measurement_.has_truth = true;
      break;
    case Input::kDriveEnabled:
      for (std::size_t joint = 0; joint < static_cast<std::size_t>(joints_); ++joint)
        drive_reports_.enabled(joint, judge(input, value));
      break;
    case Input::kDriveFault:
      drive_reports_.fault(0, !judge(input, value));
      break;
    case Input::kJointEnabled:
      drive_reports_.enabled(input.index, judge(input, value));
      break;
    case Input::kJointFault:
      drive_reports_.fault(input.index, !judge(input, value));
      break;
    case Input::kDriveTemperature:
      measurement_.drive_temperature_degC[input.index] = value;
      break;
    case Input::kDriveError:
      measurement_.drive_error[input.index] = value;
      break;
    case Input::kOperatorEnable:
      enable_stuck_ = enable_stuck_ && value > 0.5;
      measurement_.operator_enable = value > 0.5 && !enable_stuck_;
      break;
    case Input::kOperatorReset:
      reset_stuck_ = reset_stuck_ && value > 0.5;
      measurement_.operator_reset = value > 0.5 && !reset_stuck_;
      break;
    case Input::kCount:
      break;
  }
}

// Input by input: one part of a multiplexed message may be missing while the others come.
BusSet MeasurementDecoder::stale(InputGroup group, std::int64_t now_ns) const noexcept {
  BusSet buses = 0;
  for (std::size_t input = 0; input < kInputCount; ++input) {
    if (kInputKinds[input].group != group)
      continue;
    for (std::size_t i = 0; i < indices_; ++i) {
      if (seen_[input][i] && now_ns - stored_ns_[input][i] > timeouts_ns_[group])
        buses = static_cast<BusSet>(buses | busBit(buses_[input][i]));
    }
  }
  return buses;
}

Reading MeasurementDecoder::finish(std::int64_t now_ns) noexcept {
  measurement_.encoder_steps = encoder_samples_.take();
  measurement_.emg_steps = emg_samples_.take();
  measurement_.encoder_monotonic_ns = *std::min_element(arrived_ns_.begin(), arrived_ns_.begin() + joints_);
  safety::FaultSet faults;
  BusSet fault_buses = 0;
  const auto fault = [&](safety::Fault what, BusSet buses) {
    if (buses != 0)
      faults.add(what);
    fault_buses = static_cast<BusSet>(fault_buses | buses);
  };
  fault(safety::Fault::kEncoderStale, stale(kEncoderGroup, now_ns));
  fault(safety::Fault::kDriveStale, stale(kDriveGroup, now_ns));
  fault(safety::Fault::kEmgStale, stale(kEmgGroup, now_ns));
  if (stale(kOperatorGroup, now_ns) != 0) {
    enable_stuck_ = reset_stuck_ = true;
    measurement_.operator_enable = measurement_.operator_reset = false;
  }
  if (drive_reports_.finish(measurement_))
    faults.add(safety::Fault::kDriveFault);
  for (const BoundMessage& message : messages_) {
    const BusSet bus = busBit(message.decoder.layout().bus());
    if (message.corrupt.tooMany(tolerated_))
      fault(safety::Fault::kFrameCorrupt, bus);
    if (message.sequence.tooMany(tolerated_))
      fault(safety::Fault::kFrameSequence, bus);
    if (message.implausible.tooMany(tolerated_)) {
      if (message.groups[kEncoderGroup])
        fault(safety::Fault::kEncoderImplausible, bus);
      if (message.groups[kDriveGroup] || message.groups[kEmgGroup])
        fault(safety::Fault::kFrameImplausible, bus);
    }
  }
  bool complete = true;
  for (std::size_t input = 0; input < kInputCount; ++input) {
    if (kInputKinds[input].group == kNoTimeout)
      continue;
    for (std::size_t i = 0; i < indices_; ++i) {
      if (bound_[input][i] && !seen_[input][i])
        complete = false;
    }
  }
  return {.measurement = measurement_, .faults = faults, .fault_buses = fault_buses, .complete = complete};
}

}  // namespace patella::can
