#include "firmware_app/loop/loop.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "firmware_app/realtime/allocation_counter.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "firmware_app/realtime/page_faults.hpp"

namespace patella::app {
namespace {

using tick::Stage;

constexpr std::size_t kFramesPerTick = 256;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

JointArray toArray(const JointVector& vector) noexcept {
  JointArray out;
  out.fill(kUnknown);
  for (Eigen::Index i = 0; i < vector.size(); ++i) {
    out[static_cast<std::size_t>(i)] = vector[i];
  }
  return out;
}

}  // namespace

void ErrorStatistics::add(const JointVector& estimate, const JointVector& truth) noexcept {
  ++count;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const double error = std::abs(estimate[i] - truth[i]);
    sum[joint] += error;
    sum_of_squares[joint] += error * error;
    maximum[joint] = std::max(maximum[joint], error);
  }
}

Loop::Loop(const LoopOptions& options, Clock& clock, can::Bus& bus, gpio::Pins& pins,
           can::MeasurementDecoder& decoder, can::CommandEncoder& encoder, tick::Tick& tick,
           Recorder* recorder)
    : options_(options),
      period_ns_(std::llround(static_cast<double>(kNanosecondsPerSecond) / options.rate_Hz)),
      clock_(clock),
      bus_(bus),
      pins_(pins),
      decoder_(decoder),
      encoder_(encoder),
      tick_(tick),
      recorder_(recorder),
      frames_(kFramesPerTick),
      statistics_(std::make_unique<LoopStatistics>()),
      lateness_(options),
      send_failures_(options.send_failures_tolerated),
      entry_(encoder.entries(), 1.0 / options.rate_Hz) {
  stop_.torque_Nm = JointVector::Zero(tick.joints());
  stop_.state = static_cast<std::uint8_t>(safety::State::kFault);
}

void Loop::run(const std::atomic<bool>& stop) noexcept {
  CountAllocations heap;
  ThreadUsage usage_at_warm = ThreadUsage::ofThisThread();
  HeapCounts heap_at_warm = heap.counts();

  bus_.discardPending();
  // Anchored once and advanced by whole periods: a late tick does not move the ones after it. A quarter into
  // the period of the clock: a rig that samples on whole periods of the same clock has then delivered.
  start_ns_ = (clock_.now() / period_ns_ + 1) * period_ns_ + period_ns_ / 4;
  std::int64_t scheduled_ns = start_ns_;
  std::uint32_t missed = 0;
  while (!stop.load(std::memory_order_relaxed) && !bus_.exhausted() &&
         (options_.max_ticks == 0 || statistics_->ticks < options_.max_ticks)) {
    clock_.sleepUntil(scheduled_ns);
    tickOnce(scheduled_ns, missed);
    if (statistics_->ticks == static_cast<std::uint64_t>(options_.warmup_ticks)) {
      usage_at_warm = ThreadUsage::ofThisThread();
      heap_at_warm = heap.counts();
    }

    scheduled_ns += period_ns_;
    const std::int64_t behind_ns = clock_.now() - scheduled_ns;
    statistics_->overruns += behind_ns > 0 ? 1U : 0U;
    lateness_.end(behind_ns > 0);
    missed = behind_ns > 0 ? static_cast<std::uint32_t>(behind_ns / period_ns_) : 0U;
    scheduled_ns += missed * period_ns_;
    index_ += missed;
    statistics_->missed_periods += missed;
  }

  const HeapCounts heap_now = heap.counts();
  const ThreadUsage usage = ThreadUsage::ofThisThread();
  statistics_->heap_counted = CountAllocations::available();
  statistics_->heap_allocations = heap_now.allocations - heap_at_warm.allocations;
  statistics_->heap_frees = heap_now.frees - heap_at_warm.frees;
  statistics_->minor_page_faults = usage.minor_faults - usage_at_warm.minor_faults;
  statistics_->major_page_faults = usage.major_faults - usage_at_warm.major_faults;
  statistics_->voluntary_switches = usage.voluntary_switches - usage_at_warm.voluntary_switches;
  statistics_->involuntary_switches = usage.involuntary_switches - usage_at_warm.involuntary_switches;
  shutDown();
}

void Loop::tickOnce(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING {
  const std::int64_t woken_ns = clock_.now();
  statistics_->wakeup.add(woken_ns - scheduled_ns);

  drainBus(woken_ns);
  enter(probe_, Stage::kDecode);
  can::Reading reading = decoder_.finish(woken_ns);
  reading.faults = reading.faults | entry_.before(reading.measurement);
  enter(probe_, Stage::kLinesIn);
  const safety::FaultSet faults = reading.faults | hostFaults(scheduled_ns, missed);

  tick::TickInput input;
  input.measurement = reading.measurement;
  input.faults = faults;
  input.complete = reading.complete;
  input.time_s = static_cast<double>(scheduled_ns - start_ns_) / static_cast<double>(kNanosecondsPerSecond);
  const tick::TickOutput& output = tick_.step(input);
  entry_.after(output.state);

  const Command& sent = sendCommand(output.command, reading.measurement.encoder_monotonic_ns);
  heartbeat_ = !heartbeat_;
  pins_.setHeartbeat(heartbeat_);

  enter(probe_, Stage::kAccount);
  const std::int64_t done_ns = clock_.now();
  const std::int64_t execution_ns = done_ns - woken_ns;
  statistics_->execution.add(execution_ns);

  const safety::WarningSet warnings = output.warnings | hostWarnings();
  account(reading.measurement, output, sent);
  for (int i = 0; i < safety::kWarningCount; ++i) {
    statistics_->warning_ticks[static_cast<std::size_t>(i)] +=
        warnings.has(static_cast<safety::Warning>(i)) ? 1U : 0U;
  }
  record_.warnings = warnings.bits();
  record_.time_s = input.time_s;
  record_.tick = index_;
  record_.missed_periods = missed;
  record_.wakeup_latency_ns = woken_ns - scheduled_ns;
  record_.execution_ns = execution_ns;
  enter(probe_, Stage::kRecord);
  record(reading.measurement, output, sent);

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
    foreign_command_ = foreign_command_ || encoder_.commands(frame);
    decoder_.accept(frame);
  }
  enter(probe_, Stage::kRecord);
  for (std::size_t i = 0; recorder_ != nullptr && i < count; ++i) {
    if (!frames_[i].own) {
      recorder_->frame(frames_[i]);
    }
  }
}

safety::FaultSet Loop::hostFaults(std::int64_t scheduled_ns,
                                  std::uint32_t missed) noexcept PATELLA_NONBLOCKING {
  safety::FaultSet faults;
  if (pins_.emergencyStop()) {
    faults.add(safety::Fault::kEmergencyStop);
  }
  if (bus_.down()) {
    faults.add(safety::Fault::kBusOff);
  }
  if (send_failures_.exceeded()) {
    faults.add(safety::Fault::kSendFailed);
  }
  if (lateness_.begin(missed)) {
    faults.add(safety::Fault::kOverrun);
  }
  if (std::exchange(foreign_command_, false)) {
    faults.add(safety::Fault::kForeignCommand);
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
  if (wall_offset_known_ && step_s > options_.clock_step_s) {
    warnings.add(safety::Warning::kClockStepped);
    ++statistics_->clock_steps;
  }
  wall_offset_ns_ = offset_ns;
  wall_offset_known_ = true;
  if (recorder_ != nullptr && recorder_->behind()) {
    warnings.add(safety::Warning::kRecorderBehind);
  }
  if (recorder_ != nullptr && recorder_->diskLow()) {
    warnings.add(safety::Warning::kDiskLow);
  }
  if (recorder_ != nullptr && recorder_->failed()) {
    warnings.add(safety::Warning::kRecordingFailed);
  }
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
  enter(probe_, Stage::kSend);
  if (EmergencyExit::begun()) {
    return stop_;
  }
  const bool allowed = !command.enable || fresh(measured_ns);
  if (!allowed) {
    encode(stop_);
  }
  const bool gone = sendAll();
  send_failures_.update(!gone, 1.0);
  sent_wall_ns_ = gone && sent_count_ > 0 ? sent_[encoder_.size() - 1].wall_ns : 0;
  enter(probe_, Stage::kLinesOut);
  // The enable line follows the command only when every drive could be told.
  setLine(allowed && command.enable && gone, measured_ns);
  enter(probe_, Stage::kRecord);
  for (std::size_t i = 0; recorder_ != nullptr && i < sent_count_; ++i) {
    recorder_->frame(sent_[i]);
  }
  enter(probe_, Stage::kLinesOut);
  return allowed && (gone || encoder_.size() == 1) ? command : stop_;
}

void Loop::encode(const Command& command) noexcept PATELLA_NONBLOCKING {
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    commands_[drive] = encoder_.encode(command, drive);
  }
}

// One leg does not move on one drive: where one command is lost, the other drives get zero torque, those that
// have this tick's command already included.
bool Loop::sendAll() noexcept PATELLA_NONBLOCKING {
  bool gone = true;
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    if (send(gone ? commands_[drive] : encoder_.encode(stop_, drive))) {
      continue;
    }
    for (std::size_t told = 0; gone && told < drive; ++told) {
      send(encoder_.encode(stop_, told));
    }
    gone = false;
  }
  for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
    for (const can::Frame& frame : encoder_.drive(drive).frames(entry_.frames(drive))) {
      gone = send(frame) && gone;
    }
  }
  return gone;
}

bool Loop::send(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (EmergencyExit::begun() || sent_count_ == sent_.size()) {
    return false;
  }
  can::Frame& stamped = sent_[sent_count_];
  stamped = frame;
  const bool gone = bus_.send(stamped, clock_.now()) == can::SendResult::kSent;
  sent_count_ += gone ? 1U : 0U;
  return gone;
}

// Raises the line once, and takes it down as often as it must be low: where the watchdog took it down, it
// stays so. A trip that comes between the look and the rise is seen right after it.
void Loop::setLine(bool enable, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING {
  if (enable && line_up_) {
    return;
  }
  const bool raise = enable && !EmergencyExit::begun() && fresh(measured_ns);
  line_up_ = pins_.setDriveEnable(raise) && raise;
  if (line_up_ && (EmergencyExit::begun() || !fresh(measured_ns))) {
    line_up_ = false;
    pins_.setDriveEnable(false);
  }
}

void Loop::account(const Measurement& measurement, const tick::TickOutput& output,
                   const Command& sent) noexcept PATELLA_NONBLOCKING {
  LoopStatistics& s = *statistics_;
  ++s.ticks;
  ++s.state_ticks[static_cast<std::size_t>(output.state)];
  s.final_state = output.state;
  s.latched = output.latched;
  s.stops += output.entered_stop ? 1U : 0U;
  for (int i = 0; i < safety::kFaultCount; ++i) {
    const auto fault = static_cast<safety::Fault>(i);
    if (output.faults.has(fault)) {
      ++s.fault_ticks[static_cast<std::size_t>(i)];
      s.fault_events[static_cast<std::size_t>(i)] += previous_faults_.has(fault) ? 0U : 1U;
    }
  }
  previous_faults_ = output.faults;
  const auto [hip, knee] = output.limits;
  s.limit_ticks += hip.any() || knee.any() ? 1U : 0U;
  if (sent.torque_Nm.size() > 0) {
    s.max_torque_Nm = std::max(s.max_torque_Nm, sent.torque_Nm.cwiseAbs().maxCoeff());
  }
  if (measurement.has_truth && output.estimated) {
    s.sampler_error.add(output.f_s, measurement.true_f_u);
    if (output.has_network) {
      s.network_error.add(output.f_network, measurement.true_f_u);
    }
  }
  if (output.state == safety::State::kActive) {
    ++s.tracking_count;
    for (Eigen::Index i = 0; i < measurement.position_rad.size(); ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double error = output.reference.q[i] - measurement.position_rad[i];
      s.tracking_sum_of_squares[joint] += error * error;
      s.f_s_sum_of_squares[joint] += output.f_s_filtered[i] * output.f_s_filtered[i];
      s.d_hat_sum_of_squares[joint] += output.d_hat_Nm[i] * output.d_hat_Nm[i];
    }
  }
  record_.sensor_latency_ns = -1;
  if (measurement.encoder_steps > 0 && sent_wall_ns_ != 0) {
    record_.sensor_latency_ns = sent_wall_ns_ - measurement.encoder_wall_ns;
    s.sensor_to_torque.add(record_.sensor_latency_ns);
  }
}

void Loop::record(const Measurement& measurement, const tick::TickOutput& output,
                  const Command& sent) noexcept PATELLA_NONBLOCKING {
  if (recorder_ == nullptr) {
    return;
  }
  TickRecord& r = record_;
  r.q_rad = toArray(measurement.position_rad);
  r.dq_rad_s = toArray(output.velocity_rad_s);
  r.drive_torque_Nm = toArray(measurement.drive_torque_Nm);
  r.drive_temperature_degC = measurement.drive_temperature_degC;
  r.drive_error = measurement.drive_error;
  r.emg_mV = measurement.emg_mV;
  r.activation = output.activation;
  r.reference_rad = toArray(output.reference.q);
  r.reference_rad_s = toArray(output.reference.dq);
  r.f_s_rad_s2 = toArray(output.f_s);
  r.f_s_filtered_rad_s2 = toArray(output.f_s_filtered);
  r.f_network_rad_s2 = output.has_network ? toArray(output.f_network) : toArray(JointVector());
  r.f_true_rad_s2 = measurement.has_truth ? toArray(measurement.true_f_u) : toArray(JointVector());
  r.d_hat_Nm = toArray(output.d_hat_Nm);
  r.torque_gravity_Nm = toArray(output.control.gravity);
  r.torque_model_Nm = toArray(output.control.model);
  r.torque_emg_Nm = toArray(output.control.emg);
  r.torque_impedance_Nm = toArray(output.control.impedance);
  r.torque_compensation_Nm = toArray(output.control.compensation);
  r.torque_command_Nm = toArray(sent.torque_Nm);
  r.faults = output.faults.bits();
  r.limits = output.limits[0].bits() | static_cast<std::uint32_t>(output.limits[1].bits() << 8U);
  r.state = static_cast<std::uint8_t>(output.state);
  r.encoder_steps = static_cast<std::uint8_t>(std::min(measurement.encoder_steps, 255));
  recorder_->tick(r);
}

void Loop::shutDown() noexcept {
  pins_.setDriveEnable(false);
  Command stop;
  stop.torque_Nm = JointVector::Zero(tick_.joints());
  stop.state = static_cast<std::uint8_t>(safety::State::kInit);
  // Not while a signal handler sends its own: the counters of the two would meet.
  for (int i = 0; i < options_.shutdown_frames && !EmergencyExit::begun(); ++i) {
    encode(stop);
    clock_.sleepUntil(clock_.now() + period_ns_);
    sent_count_ = 0;
    for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
      send(commands_[drive]);
    }
    for (std::size_t drive = 0; drive < encoder_.size(); ++drive) {
      for (const can::Frame& frame : encoder_.drive(drive).frames(safety::DriveFrames::kLeave)) {
        send(frame);
      }
    }
    for (std::size_t k = 0; recorder_ != nullptr && k < sent_count_; ++k) {
      recorder_->frame(sent_[k]);
    }
  }
}

}  // namespace patella::app
