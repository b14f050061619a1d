#include "firmware_app/loop/loop.hpp"

#include <cmath>
#include <utility>

#include "firmware_app/realtime/emergency_exit.hpp"

namespace patella::app {
namespace {

using tick::Stage;

constexpr std::size_t kFramesPerTick = 256;  // of each bus

}  // namespace

Loop::Loop(const LoopParts& parts)
    : options_(parts.options),
      period_ns_(std::llround(static_cast<double>(kNanosecondsPerSecond) / parts.options.rate_Hz)),
      clock_(parts.clock),
      bus_(parts.bus),
      pins_(parts.pins),
      decoder_(parts.decoder),
      encoder_(parts.encoder),
      tick_(parts.tick),
      sink_(parts.sink),
      frames_(kFramesPerTick * parts.options.buses),
      lateness_(parts.options),
      send_failures_(parts.options.send_failures_tolerated),
      entry_(parts.encoder.entries(), 1.0 / parts.options.rate_Hz),
      nodes_(parts.canopen, 1.0 / parts.options.rate_Hz) {
  stop_.torque_Nm = JointVector::Zero(tick_.joints());
  stop_.state = static_cast<std::uint8_t>(safety::State::kFault);
}

void Loop::run(const std::atomic<bool>& stop) noexcept {
  sink_.begin();
  bus_.discardPending();
  // Anchored once and advanced by whole periods: a late tick does not move the ones after it. A quarter into
  // the period of the clock: a rig that samples on whole periods of the same clock has then delivered.
  start_offset_ns_ = wall_offset_ns_ = clock_.wallNow() - clock_.now();
  start_ns_ = (clock_.now() / period_ns_ + 1) * period_ns_ + period_ns_ / 4;
  std::int64_t scheduled_ns = start_ns_;
  std::uint32_t missed = 0;
  while (!stop.load(std::memory_order_relaxed) && !bus_.exhausted() &&
         (options_.max_ticks == 0 || ticks_ < options_.max_ticks)) {
    clock_.sleepUntil(scheduled_ns);
    tickOnce(scheduled_ns, missed);
    ++ticks_;

    scheduled_ns += period_ns_;
    const std::int64_t behind_ns = clock_.now() - scheduled_ns;
    lateness_.end(behind_ns > 0);
    missed = behind_ns > 0 ? static_cast<std::uint32_t>(behind_ns / period_ns_) : 0U;
    scheduled_ns += missed * period_ns_;
    index_ += missed;
    sink_.tickEnded(behind_ns > 0, missed);
  }
  sink_.end();
  shutDown();
}

void Loop::tickOnce(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING {
  const std::int64_t woken_ns = clock_.now();
  drainBus(woken_ns);
  enter(probe_, Stage::kDecode);
  can::Reading reading = decoder_.finish(woken_ns);
  reading.faults = reading.faults | nodes_.finish(woken_ns, reading.measurement);
  fault_buses_ = static_cast<can::BusSet>(reading.fault_buses | nodes_.faultBuses());
  reading.faults = reading.faults | entry_.before(reading.measurement);
  enter(probe_, Stage::kLinesIn);
  const safety::FaultSet faults = reading.faults | hostFaults(scheduled_ns, missed);

  const tick::TickInput input{
      .measurement = reading.measurement,
      .faults = faults,
      .complete = reading.complete,
      .time_s = static_cast<double>(scheduled_ns - start_ns_) / static_cast<double>(kNanosecondsPerSecond)};
  const tick::TickOutput& output = tick_.step(input);
  entry_.after(output.state);
  chooseControlwords();

  const Command& sent = sendCommand(output.command, reading.measurement.encoder_monotonic_ns);
  heartbeat_ = !heartbeat_;
  if (!pins_.setHeartbeat(heartbeat_)) {
    late_faults_.add(safety::Fault::kLineRefused);
  }

  enter(probe_, Stage::kAccount);
  const std::int64_t execution_ns = clock_.now() - woken_ns;
  sink_.tick({.tick = index_,
              .time_s = input.time_s,
              .wall_ns = scheduled_ns + start_offset_ns_,
              .missed_periods = missed,
              .wakeup_latency_ns = woken_ns - scheduled_ns,
              .execution_ns = execution_ns,
              .sensor_latency_ns = sensorLatency_ns(reading.measurement),
              .warnings = output.warnings | hostWarnings(),
              .measurement = reading.measurement,
              .output = output,
              .sent = sent,
              .notices = nodes_.notices(),
              .fault_buses = fault_buses_});

  // Phase two: what the next tick can have ready before its frame arrives.
  enter(probe_, Stage::kNetworkPrepare);
  tick_.prepareNext();
  enter(probe_, Stage::kOutside);
  ++index_;
}

void Loop::drainBus(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  enter(probe_, Stage::kReceive);
  const std::size_t count = bus_.receive(frames_, now_ns);
  enter(probe_, Stage::kDecode);
  for (std::size_t i = 0; i < count; ++i) {
    const can::Frame& frame = frames_[i];
    if (frame.own) {
      continue;
    }
    // Whoever else commands the drives has them: they obey the newest frame.
    if (encoder_.commands(frame) || nodes_.reserved(frame)) {
      foreign_ = static_cast<can::BusSet>(foreign_ | can::busBit(frame.bus));
    }
    nodes_.accept(frame);
    decoder_.accept(frame);
  }
  enter(probe_, Stage::kRecord);
  for (std::size_t i = 0; i < count; ++i) {
    if (!frames_[i].own) {
      sink_.frame(frames_[i]);
    }
  }
}

safety::FaultSet Loop::hostFaults(std::int64_t scheduled_ns,
                                  std::uint32_t missed) noexcept PATELLA_NONBLOCKING {
  safety::FaultSet faults;
  const auto add_of_bus = [&](safety::Fault fault, can::BusSet buses) {
    faults.add(fault);
    fault_buses_ = static_cast<can::BusSet>(fault_buses_ | buses);
  };
  if (pins_.emergencyStop()) {
    faults.add(safety::Fault::kEmergencyStop);
  }
  if (const can::BusSet down = bus_.downBuses(); down != 0) {
    add_of_bus(safety::Fault::kBusOff, down);
  }
  if (send_failures_.exceeded()) {
    add_of_bus(safety::Fault::kSendFailed, unsent_);
  }
  if (lateness_.begin(missed)) {
    faults.add(safety::Fault::kOverrun);
  }
  if (const can::BusSet foreign = std::exchange(foreign_, can::BusSet{0}); foreign != 0) {
    add_of_bus(safety::Fault::kForeignCommand, foreign);
  }
  faults = faults | std::exchange(late_faults_, {});
  if (watchdog_ != nullptr) {
    watchdog_->beat(scheduled_ns);
    if (watchdog_->takeTrip()) {
      faults.add(safety::Fault::kWatchdog);
    }
  }
  return faults;
}

safety::WarningSet Loop::hostWarnings() noexcept PATELLA_NONBLOCKING {
  safety::WarningSet warnings;
  const std::int64_t offset_ns = clock_.wallNow() - clock_.now();
  const double step_s =
      static_cast<double>(std::abs(offset_ns - wall_offset_ns_)) / static_cast<double>(kNanosecondsPerSecond);
  if (step_s > options_.clock_step_s) {
    warnings.add(safety::Warning::kClockStepped);
  }
  wall_offset_ns_ = offset_ns;
  return warnings;
}

// Whether torque may still follow from what was measured then: a stall within the tick makes it old, and the
// watchdog may have taken the line down meanwhile.
bool Loop::fresh(std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING {
  const bool old = clock_.now() - measured_ns > decoder_.encoderTimeout_ns();
  const bool tripped = watchdog_ != nullptr && watchdog_->tripped();
  if (old || tripped) {
    late_faults_.add(safety::Fault::kCommandLate);
  }
  return !old && !tripped;
}

const Command& Loop::sendCommand(const Command& command,
                                 std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING {
  enter(probe_, Stage::kEncode);
  sent_count_ = 0;
  sent_wall_ns_ = 0;
  if (EmergencyExit::begun()) {
    return stop_;  // the handler of the signal that ends the process has the encoder, the bus and the line
  }
  encode(command);
  const Sent sent = sendAll(command.enable, measured_ns);
  send_failures_.update(!sent.whole, 1.0);
  unsent_ = sent.whole ? can::BusSet{0} : unsent_;
  sent_wall_ns_ = sent.whole && sent_count_ > 0 ? sent_[encoder_.size() - 1].wall_ns : 0;
  enter(probe_, Stage::kLinesOut);
  // The enable line follows the command only when every drive could be told.
  setLine(sent.as_computed && command.enable, measured_ns);
  enter(probe_, Stage::kRecord);
  for (std::size_t i = 0; i < sent_count_; ++i) {
    sink_.frame(sent_[i]);
  }
  enter(probe_, Stage::kLinesOut);
  return sent.as_computed ? command : stop_;
}

// A controlword follows from how far the drive is, and not from the command's enable: the drives have to be
// in before there is one.
void Loop::chooseControlwords() noexcept PATELLA_NONBLOCKING {
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    const int node = encoder_.drive(drive).node();
    controlwords_[drive] =
        node == 0 ? std::uint16_t{0} : nodes_.controlword(node, entry_.phase(drive), entry_.frames(drive));
  }
}

void Loop::encode(const Command& command) noexcept PATELLA_NONBLOCKING {
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    commands_[drive] = encoder_.encode(command, drive, controlwords_[drive]);
  }
}

// One leg does not move on one drive: from where a command is lost, or has become too old between two frames,
// the drives get zero torque, those that have this tick's command already included.
Loop::Sent Loop::sendAll(bool torque, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING {
  Sent sent;
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    enter(probe_, Stage::kSend);
    const bool before = sent.as_computed;
    sent.as_computed = before && (!torque || fresh(measured_ns));
    sent.whole = send(sent.as_computed ? commands_[drive] : stopFrame(drive)) && sent.whole;
    sent.as_computed = sent.as_computed && sent.whole;
    for (std::size_t told = 0; before && !sent.as_computed && told < drive; ++told) {
      send(stopFrame(told));
    }
  }
  bool told = true;
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    told = sendEach(encoder_.drive(drive).frames(entry_.frames(drive))) && told;
  }
  told = sendEach(nodes_.cycle()) && told;
  sent.whole = sent.whole && told;
  return sent;
}

bool Loop::sendEach(std::span<const can::Frame> frames) noexcept PATELLA_NONBLOCKING {
  bool whole = true;
  for (const can::Frame& frame : frames) {
    whole = send(frame) && whole;
  }
  return whole;
}

bool Loop::send(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (EmergencyExit::begun() || sent_count_ == sent_.size()) {
    return false;
  }
  can::Frame& stamped = sent_[sent_count_];
  stamped = frame;
  const bool gone = bus_.send(stamped, clock_.now()) == can::SendResult::kSent;
  sent_count_ += gone ? 1U : 0U;
  unsent_ = static_cast<can::BusSet>(unsent_ | (gone ? 0 : can::busBit(frame.bus)));
  return gone;
}

// Raises the line once, and takes it down as often as it must be low: where the watchdog took it down, it
// stays so. A trip that comes between the look and the rise is seen right after it.
void Loop::setLine(bool enable, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING {
  if (enable && line_up_) {
    return;
  }
  const bool raise = enable && !EmergencyExit::begun() && fresh(measured_ns);
  line_up_ = setLevel(raise) && raise;
  if (line_up_ && (EmergencyExit::begun() || !fresh(measured_ns))) {
    line_up_ = false;
    setLevel(false);
  }
}

bool Loop::setLevel(bool enable) noexcept PATELLA_NONBLOCKING {
  const bool taken = pins_.setDriveEnable(enable);
  if (!taken) {
    late_faults_.add(safety::Fault::kLineRefused);
  }
  return taken;
}

std::optional<std::int64_t> Loop::sensorLatency_ns(const Measurement& measurement) const noexcept
    PATELLA_NONBLOCKING {
  if (measurement.encoder_steps <= 0 || sent_wall_ns_ == 0) {
    return std::nullopt;
  }
  return sent_wall_ns_ - measurement.encoder_wall_ns;
}

void Loop::shutDown() noexcept {
  pins_.setDriveEnable(false);
  Command stop;
  stop.torque_Nm = JointVector::Zero(tick_.joints());
  stop.state = static_cast<std::uint8_t>(safety::State::kInit);
  controlwords_ = {};
  // Not while a signal handler sends its own: the counters of the two would meet.
  for (int i = 0; i < options_.shutdown_frames && !EmergencyExit::begun(); ++i) {
    encode(stop);
    clock_.sleepUntil(clock_.now() + period_ns_);
    sent_count_ = 0;
    for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
      send(commands_[drive]);
    }
    for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
      sendEach(encoder_.drive(drive).frames(safety::DriveFrames::kLeave));
    }
    sendEach(nodes_.cycle());
    if (i + 1 == options_.shutdown_frames) {
      sendEach(nodes_.farewell());
    }
    for (std::size_t k = 0; k < sent_count_; ++k) {
      sink_.frame(sent_[k]);
    }
  }
}

}  // namespace patella::app
