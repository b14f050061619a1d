// The fixed-rate loop: wake, drain the bus, one tick of core, send, record. The same code on every backend.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/safety/drive_entry.hpp"
#include "core/safety/fault.hpp"
#include "core/tick/tick.hpp"
#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/loop/latency_histogram.hpp"
#include "firmware_app/loop/lateness.hpp"
#include "firmware_app/realtime/watchdog.hpp"
#include "firmware_app/recorder/recorder.hpp"

namespace patella::app {

struct LoopOptions : LatenessLimits {
  std::uint64_t max_ticks = 0;      ///< 0: until stopped or the backend is exhausted
  int send_failures_tolerated = 3;  ///< commands that may be lost in a row, or among others, before a fault
  double clock_step_s = 0.05;       ///< change of wall time against the loop's clock that is told of
  int warmup_ticks = 200;           ///< heap operations and page faults are counted from here on
  int shutdown_frames = 10;         ///< zero-torque, drives-disabled frames sent when the loop ends
};

/// Mean, RMS and maximum of |f_s − f_u| where the rig tells the truth.
struct ErrorStatistics {
  std::uint64_t count = 0;
  JointArray sum{}, sum_of_squares{}, maximum{};
  void add(const JointVector& estimate, const JointVector& truth) noexcept;
};

/// What the loop counts while it runs; plain numbers, read when it has ended.
struct LoopStatistics {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;        ///< ticks that ended after the next one was due
  std::uint64_t missed_periods = 0;  ///< whole periods skipped because of them
  LatencyHistogram wakeup, execution, sensor_to_torque;
  std::uint64_t heap_allocations = 0, heap_frees = 0;  ///< by the loop thread after warm-up
  bool heap_counted = false;                           ///< false in sanitizer builds
  std::uint64_t minor_page_faults = 0, major_page_faults = 0;
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;
  std::array<std::uint64_t, safety::kFaultCount> fault_ticks{};   ///< ticks in which each cause was present
  std::array<std::uint64_t, safety::kFaultCount> fault_events{};  ///< times each cause appeared
  std::array<std::uint64_t, safety::kWarningCount> warning_ticks{};
  std::uint64_t clock_steps = 0;
  std::uint64_t limit_ticks = 0;  ///< ticks in which a limit held the command back
  std::uint64_t stops = 0;        ///< entries into limited or fault
  std::array<std::uint64_t, safety::kStateCount> state_ticks{};
  safety::State final_state = safety::State::kInit;
  safety::FaultSet latched;
  double max_torque_Nm = 0.0;
  ErrorStatistics sampler_error, network_error;
  JointArray tracking_sum_of_squares{};  ///< rad², while active and a reference exists
  JointArray f_s_sum_of_squares{};       ///< (rad/s²)², of the filtered estimate while active
  JointArray d_hat_sum_of_squares{};     ///< (N·m)², likewise
  std::uint64_t tracking_count = 0;
};

class Loop {
 public:
  /// All references must outlive the loop. `recorder` may be null.
  Loop(const LoopOptions& options, Clock& clock, can::Bus& bus, gpio::Pins& pins,
       can::MeasurementDecoder& decoder, can::CommandEncoder& encoder, tick::Tick& tick, Recorder* recorder);

  /// Before run(): somebody who watches, and must outlive the loop.
  void watchedBy(Watchdog& watchdog) noexcept { watchdog_ = &watchdog; }

  /// Before run(): somebody who measures the stages of a tick, and must outlive the loop.
  void probedBy(tick::StageProbe& probe) noexcept {
    probe_ = &probe;
    tick_.probedBy(probe);
  }

  /// Runs in the calling thread until max_ticks, until the bus is exhausted, or until `stop` is set; then
  /// sends zero torque and drops drive enable.
  void run(const std::atomic<bool>& stop) noexcept;

  const LoopStatistics& statistics() const noexcept { return *statistics_; }

 private:
  /// Frames of a tick: a command for each drive, zero torque in its place, and those that it enters by.
  static constexpr std::size_t kMostSent = std::size_t{10} * kMaxJoints;

  void tickOnce(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING;
  void drainBus(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  safety::FaultSet hostFaults(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING;
  safety::WarningSet hostWarnings() noexcept PATELLA_NONBLOCKING;
  /// Sends it to every drive, or zero torque where it comes too late or some drive cannot be told; returns
  /// what was sent.
  const Command& sendCommand(const Command& command, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  void encode(const Command& command) noexcept PATELLA_NONBLOCKING;
  bool sendAll() noexcept PATELLA_NONBLOCKING;
  bool send(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;
  bool fresh(std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  void setLine(bool enable, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  void account(const Measurement& measurement, const tick::TickOutput& output,
               const Command& sent) noexcept PATELLA_NONBLOCKING;
  void record(const Measurement& measurement, const tick::TickOutput& output,
              const Command& sent) noexcept PATELLA_NONBLOCKING;
  void shutDown() noexcept;

  LoopOptions options_;
  std::int64_t period_ns_;
  Clock& clock_;
  can::Bus& bus_;
  gpio::Pins& pins_;
  can::MeasurementDecoder& decoder_;
  can::CommandEncoder& encoder_;
  tick::Tick& tick_;
  Recorder* recorder_;
  Watchdog* watchdog_ = nullptr;
  tick::StageProbe* probe_ = nullptr;
  std::vector<can::Frame> frames_;
  std::unique_ptr<LoopStatistics> statistics_;
  TickRecord record_;
  std::int64_t start_ns_ = 0;
  std::uint64_t index_ = 0;
  Lateness lateness_;
  safety::LeakyScore send_failures_;  ///< commands
  safety::FaultSet late_faults_;      ///< found after the tick was computed; the next one makes them latch
  safety::DriveEntry entry_;
  std::array<can::Frame, kMaxJoints> commands_;  ///< of this tick, one for each drive
  std::array<can::Frame, kMostSent> sent_;       ///< in this tick, for the record
  std::size_t sent_count_ = 0;
  Command stop_;                  ///< what is sent in place of a command that comes too late
  bool foreign_command_ = false;  ///< seen in this tick
  bool line_up_ = false;          ///< as this loop set it
  std::int64_t sent_wall_ns_ = 0;
  std::int64_t wall_offset_ns_ = 0;
  bool wall_offset_known_ = false;
  safety::FaultSet previous_faults_;
  bool heartbeat_ = false;
};

}  // namespace patella::app
