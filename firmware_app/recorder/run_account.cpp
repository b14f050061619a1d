#include "firmware_app/recorder/run_account.hpp"

#include <algorithm>
#include <limits>

namespace patella::app {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr unsigned kLimitBitsPerJoint = 8;

/// The joint's number, or not known where the vector has none.
double of(const JointVector& vector, Eigen::Index joint) noexcept {
  return joint < vector.size() ? vector[joint] : kUnknown;
}

void fill(JointRecord& r, const TickReport& report, Eigen::Index j) noexcept PATELLA_NONBLOCKING {
  const Measurement& measurement = report.measurement;
  const tick::TickOutput& output = report.output;
  const auto index = static_cast<std::size_t>(j);
  r.q_rad = measurement.position_rad[j];
  r.dq_rad_s = of(output.velocity_rad_s, j);
  r.drive_torque_Nm = of(measurement.drive_torque_Nm, j);
  r.drive_temperature_degC = measurement.drive_temperature_degC[index];
  r.drive_error = measurement.drive_error[index];
  r.reference_rad = of(output.reference.q, j);
  r.reference_rad_s = of(output.reference.dq, j);
  r.f_s_rad_s2 = of(output.f_s, j);
  r.f_s_filtered_rad_s2 = of(output.f_s_filtered, j);
  r.f_network_rad_s2 = output.has_network ? of(output.f_network, j) : kUnknown;
  r.f_true_rad_s2 = measurement.has_truth ? of(measurement.true_f_u, j) : kUnknown;
  r.d_hat_Nm = of(output.d_hat_Nm, j);
  r.torque_gravity_Nm = of(output.control.gravity, j);
  r.torque_model_Nm = of(output.control.model, j);
  r.torque_emg_Nm = of(output.control.emg, j);
  r.torque_impedance_Nm = of(output.control.impedance, j);
  r.torque_compensation_Nm = of(output.control.compensation, j);
  r.torque_command_Nm = of(report.sent.torque_Nm, j);
}

void fill(TickRecord& r, const TickReport& report) noexcept PATELLA_NONBLOCKING {
  const Measurement& measurement = report.measurement;
  const tick::TickOutput& output = report.output;
  r.tick = report.tick;
  r.time_s = report.time_s;
  r.wall_ns = report.wall_ns;
  r.missed_periods = report.missed_periods;
  r.wakeup_latency_ns = report.wakeup_latency_ns;
  r.execution_ns = report.execution_ns;
  r.sensor_latency_ns = report.sensor_latency_ns.value_or(-1);
  r.emg_mV = measurement.emg_mV;
  r.activation = output.activation;
  r.faults = output.faults.bits();
  r.limits = 0;
  r.joints = static_cast<std::uint32_t>(measurement.position_rad.size());
  for (std::uint32_t joint = 0; joint < r.joints; ++joint) {
    fill(r.joint[joint], report, joint);
  }
  for (std::size_t joint = 0; joint < output.limits.size(); ++joint) {
    r.limits |= static_cast<std::uint64_t>(output.limits[joint].bits()) << (kLimitBitsPerJoint * joint);
  }
  r.state = static_cast<std::uint8_t>(output.state);
  r.notices = report.notices;
  r.fault_buses = report.fault_buses;
  r.encoder_steps = static_cast<std::uint8_t>(std::min(measurement.encoder_steps, 255));
}

}  // namespace

RunAccount::RunAccount(const AccountOptions& options, Recorder* recorder)
    : options_(options), recorder_(recorder), statistics_(std::make_unique<LoopStatistics>()) {}

RunAccount::Usage RunAccount::usage() const noexcept {
  return {.heap = heap_->counts(), .thread = ThreadUsage::ofThisThread()};
}

void RunAccount::begin() noexcept {
  heap_.emplace();
  warm_ = usage();
}

void RunAccount::end() noexcept {
  const auto [heap, thread] = usage();
  LoopStatistics& s = *statistics_;
  s.heap_counted = CountAllocations::available();
  s.heap_allocations = heap.allocations - warm_.heap.allocations;
  s.heap_frees = heap.frees - warm_.heap.frees;
  s.minor_page_faults = thread.minor_faults - warm_.thread.minor_faults;
  s.major_page_faults = thread.major_faults - warm_.thread.major_faults;
  s.voluntary_switches = thread.voluntary_switches - warm_.thread.voluntary_switches;
  s.involuntary_switches = thread.involuntary_switches - warm_.thread.involuntary_switches;
  heap_.reset();
}

void RunAccount::frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (recorder_ != nullptr) {
    recorder_->frame(frame);
  }
}

void RunAccount::tick(const TickReport& report) noexcept PATELLA_NONBLOCKING {
  count(report);
  const safety::WarningSet warnings = report.warnings | recorderWarnings();
  for (int i = 0; i < safety::kWarningCount; ++i) {
    statistics_->warning_ticks[static_cast<std::size_t>(i)] +=
        warnings.has(static_cast<safety::Warning>(i)) ? 1U : 0U;
  }
  if (recorder_ != nullptr) {
    fill(record_, report);
    record_.warnings = warnings.bits();
    recorder_->tick(record_);
  }
}

void RunAccount::tickEnded(bool overrun, std::uint32_t missed) noexcept {
  if (statistics_->ticks == static_cast<std::uint64_t>(options_.warmup_ticks)) {
    warm_ = usage();
  }
  statistics_->overruns += overrun ? 1U : 0U;
  statistics_->missed_periods += missed;
}

safety::WarningSet RunAccount::recorderWarnings() noexcept PATELLA_NONBLOCKING {
  safety::WarningSet warnings;
  if (recorder_ == nullptr) {
    return warnings;
  }
  if (recorder_->behind()) {
    warnings.add(safety::Warning::kRecorderBehind);
  }
  if (recorder_->diskLow()) {
    warnings.add(safety::Warning::kDiskLow);
  }
  if (recorder_->failed()) {
    warnings.add(safety::Warning::kRecordingFailed);
  }
  return warnings;
}

void RunAccount::count(const TickReport& report) noexcept PATELLA_NONBLOCKING {
  LoopStatistics& s = *statistics_;
  ++s.ticks;
  s.wakeup.add(report.wakeup_latency_ns);
  s.execution.add(report.execution_ns);
  // In init frames are taken that waited while the program set itself up, and no torque flows.
  if (report.sensor_latency_ns && report.output.state != safety::State::kInit) {
    s.sensor_to_torque.add(*report.sensor_latency_ns);
  }
  countSafety(report);
  countEstimates(report);
}

void RunAccount::countSafety(const TickReport& report) noexcept PATELLA_NONBLOCKING {
  LoopStatistics& s = *statistics_;
  const tick::TickOutput& output = report.output;
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
  for (std::size_t bus = 0; bus < can::kMaxBuses; ++bus) {
    s.bus_fault_ticks[bus] += (report.fault_buses & can::busBit(bus)) != 0 ? 1U : 0U;
  }
  bool limited = false;
  for (const safety::LimitSet& limits : output.limits) {
    limited = limited || limits.any();
  }
  s.limit_ticks += limited ? 1U : 0U;
  if (report.sent.torque_Nm.size() > 0) {
    s.max_torque_Nm = std::max(s.max_torque_Nm, report.sent.torque_Nm.cwiseAbs().maxCoeff());
  }
}

void RunAccount::countEstimates(const TickReport& report) noexcept PATELLA_NONBLOCKING {
  LoopStatistics& s = *statistics_;
  const Measurement& measurement = report.measurement;
  const tick::TickOutput& output = report.output;
  if (measurement.has_truth && output.estimated) {
    s.sampler_error.add(output.f_s, measurement.true_f_u);
    s.filtered_error.add(output.f_s_filtered, measurement.true_f_u);
    if (output.has_network) {
      s.network_error.add(output.f_network, measurement.true_f_u);
    }
  }
  if (output.state != safety::State::kActive) {
    return;
  }
  ++s.tracking_count;
  for (Eigen::Index i = 0; i < measurement.position_rad.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const double error = output.reference.q[i] - measurement.position_rad[i];
    s.tracking_sum_of_squares[joint] += error * error;
    s.f_s_sum_of_squares[joint] += output.f_s_filtered[i] * output.f_s_filtered[i];
    s.d_hat_sum_of_squares[joint] += output.d_hat_Nm[i] * output.d_hat_Nm[i];
  }
}

}  // namespace patella::app
