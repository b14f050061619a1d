// Frames in, command out, as the loop puts decoder and tick together; and what must hold whatever comes in.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "firmware_app/configuration/run_config.hpp"

namespace patella::test {

class TickUnderTest {
 public:
  explicit TickUnderTest(const app::RunConfig& config)
      : limits_(config.tick.limits),
        period_s_(1.0 / config.loop.rate_Hz),
        decoder_(app::makeDecoder(config)),
        tick_(app::makeTick(config)),
        last_Nm_(JointVector::Zero(config.model.joints())) {}

  /// One tick, a period after the one before, with these frames and what the host has found. The statement
  /// that does not hold, or null.
  const char* step(std::span<const can::Frame> frames, safety::FaultSet host) {
    now_ns_ += static_cast<std::int64_t>(period_s_ * 1e9);
    for (can::Frame frame : frames) {
      frame.monotonic_ns = now_ns_;
      decoder_.accept(frame);
    }
    const can::Reading reading = decoder_.finish(now_ns_);
    tick::TickInput input;
    input.measurement = reading.measurement;
    input.faults = reading.faults | host;
    input.complete = reading.complete;
    input.time_s = static_cast<double>(now_ns_) * 1e-9;
    const tick::TickOutput& output = tick_->step(input);
    tick_->prepareNext();
    const char* broken = judge(output, reading.measurement);
    state_ = output.state;
    enable_ = reading.measurement.operator_enable;
    reset_ = reading.measurement.operator_reset;
    last_Nm_ = output.command.torque_Nm;
    return broken;
  }

  std::int64_t now_ns() const noexcept { return now_ns_; }
  safety::State state() const noexcept { return state_; }
  const JointVector& torque_Nm() const noexcept { return last_Nm_; }

 private:
  const char* judge(const tick::TickOutput& output, const Measurement& measurement) const {
    using safety::State;
    const Command& command = output.command;
    const bool active = output.state == State::kActive;
    if (command.torque_Nm.size() != last_Nm_.size() || !command.torque_Nm.allFinite()) {
      return "a command is finite";
    }
    if (command.enable != active || (!active && !command.torque_Nm.isZero(0.0))) {
      return "torque flows in the active state only";
    }
    if (output.faults.any() && (active || !command.torque_Nm.isZero(0.0))) {
      return "a fault takes torque away in its own tick";
    }
    for (Eigen::Index j = 0; j < last_Nm_.size(); ++j) {
      const safety::JointLimits& limits = limits_.joint[static_cast<std::size_t>(j)];
      const double torque_Nm = command.torque_Nm[j];
      if (std::abs(torque_Nm) > limits.torque_Nm) {
        return "a command is within the torque limit";
      }
      const double from_Nm = torque_Nm * last_Nm_[j] > 0.0 ? std::abs(last_Nm_[j]) : 0.0;
      if (std::abs(torque_Nm) - from_Nm > limits.torque_rate_Nm_s * period_s_ * (1.0 + 1e-9)) {
        return "a command grows within the rate";
      }
    }
    const bool was_latched = state_ == State::kFault || state_ == State::kLimited;
    const bool is_latched = output.state == State::kFault || output.state == State::kLimited;
    if (was_latched && !is_latched && (!measurement.operator_reset || reset_ || output.faults.any())) {
      return "a latched stop ends by an edge of reset without a fault";
    }
    if (active && state_ != State::kActive &&
        (state_ != State::kReady || !measurement.operator_enable || enable_)) {
      return "activity begins in ready by an edge of enable";
    }
    return nullptr;
  }

  safety::SafetyLimits limits_;
  double period_s_;
  can::MeasurementDecoder decoder_;
  std::unique_ptr<tick::Tick> tick_;
  JointVector last_Nm_;
  std::int64_t now_ns_ = 1'000'000'000;
  safety::State state_ = safety::State::kInit;
  bool enable_ = true;
  bool reset_ = true;
};

}  // namespace patella::test
