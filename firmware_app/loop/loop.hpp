// The fixed-rate loop: wake, drain the bus, one tick of core, send, report. The same code on every backend.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/safety/drive_entry.hpp"
#include "core/safety/fault.hpp"
#include "core/tick/tick.hpp"
#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/canopen/drive_nodes.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/loop/lateness.hpp"
#include "firmware_app/loop/loop_options.hpp"
#include "firmware_app/loop/loop_sink.hpp"
#include "firmware_app/realtime/watchdog.hpp"

namespace patella::app {

/// Parts of a loop. All references must outlive it.
struct LoopParts {
  LoopOptions options;
  Clock& clock;
  can::Bus& bus;
  gpio::Pins& pins;
  can::MeasurementDecoder& decoder;
  can::CommandEncoder& encoder;
  tick::Tick& tick;
  LoopSink& sink;
  canopen::CanopenMap canopen{};  ///< CiA 402 drives, set up already; a copy is kept
};

class Loop {
 public:
  explicit Loop(const LoopParts& parts);

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

 private:
  /// Frames of a tick: a command for each drive, zero torque in its place, those that it enters by, and SYNC
  /// with the heartbeat.
  static constexpr std::size_t kMostSent = std::size_t{10} * kMaxJoints;

  void tickOnce(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING;
  void drainBus(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  safety::FaultSet hostFaults(std::int64_t scheduled_ns, std::uint32_t missed) noexcept PATELLA_NONBLOCKING;
  safety::WarningSet hostWarnings() noexcept PATELLA_NONBLOCKING;
  struct Sent {
    bool whole = true;        ///< every frame went out
    bool as_computed = true;  ///< every drive has this tick's command
  };
  /// Sends it to every drive, or zero torque where it comes too late or some drive cannot be told; returns
  /// what the drives are left with: where even zero torque is lost, the enable line is low.
  const Command& sendCommand(const Command& command, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  void chooseControlwords() noexcept PATELLA_NONBLOCKING;
  void encode(const Command& command) noexcept PATELLA_NONBLOCKING;
  can::Frame stopFrame(std::size_t drive) noexcept PATELLA_NONBLOCKING {
    return encoder_.encode(stop_, drive, controlwords_[drive]);
  }
  Sent sendAll(bool torque, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  bool send(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;
  bool sendEach(std::span<const can::Frame> frames) noexcept PATELLA_NONBLOCKING;  ///< all went out
  bool fresh(std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  void setLine(bool enable, std::int64_t measured_ns) noexcept PATELLA_NONBLOCKING;
  bool setLevel(bool enable) noexcept PATELLA_NONBLOCKING;
  std::optional<std::int64_t> sensorLatency_ns(const Measurement& measurement) const noexcept
      PATELLA_NONBLOCKING;
  void shutDown() noexcept;

  LoopOptions options_;
  std::int64_t period_ns_;
  Clock& clock_;
  can::Bus& bus_;
  gpio::Pins& pins_;
  can::MeasurementDecoder& decoder_;
  can::CommandEncoder& encoder_;
  tick::Tick& tick_;
  LoopSink& sink_;
  Watchdog* watchdog_ = nullptr;
  tick::StageProbe* probe_ = nullptr;
  std::vector<can::Frame> frames_;
  std::int64_t start_ns_ = 0;
  std::uint64_t ticks_ = 0;  ///< done
  std::uint64_t index_ = 0;  ///< of the period
  Lateness lateness_;
  safety::LeakyScore send_failures_;  ///< commands
  safety::FaultSet late_faults_;      ///< found after the tick was computed; the next one makes them latch
  safety::DriveEntry entry_;
  canopen::DriveNodes nodes_;
  std::array<std::uint16_t, kMaxJoints> controlwords_{};  ///< of this tick, for drives that take one
  std::array<can::Frame, kMaxJoints> commands_;           ///< of this tick, one for each drive
  std::array<can::Frame, kMostSent> sent_;                ///< in this tick, for the record
  std::size_t sent_count_ = 0;
  Command stop_;                 ///< what is sent in place of a command that comes too late
  can::BusSet foreign_ = 0;      ///< buses on which a foreign command was seen in this tick
  can::BusSet unsent_ = 0;       ///< buses that did not take a frame, since a tick in which all went out
  can::BusSet fault_buses_ = 0;  ///< of this tick's faults
  bool line_up_ = false;         ///< as this loop set it
  std::int64_t sent_wall_ns_ = 0;
  std::int64_t start_offset_ns_ = 0;  ///< of the wall clock when the run began: records are stamped by it
  std::int64_t wall_offset_ns_ = 0;   ///< at the last tick
  bool heartbeat_ = false;
};

}  // namespace patella::app
