// The in-process rig in lock step with the loop: time passes for it only when the loop looks at its bus.
#pragma once

#include "drivers/can/arrival_clock.hpp"
#include "drivers/can/bus.hpp"
#include "drivers/can/error_monitor.hpp"
#include "drivers/clock/clock.hpp"
#include "sim/rig.hpp"

namespace patella::sim {

/// receive() advances the rig to the tick's instant and delivers its frames, so that the tick at t sees the
/// encoder sample of t; a command sent in that tick acts from t on. With a VirtualClock a run repeats to the
/// bit, whatever the machine. For one thread.
class SimulatedBus final : public can::Bus {
 public:
  /// Both must outlive the bus. Stamps keep the offset between the clock's two times found here.
  SimulatedBus(Rig& rig, const Clock& clock) noexcept
      : rig_(rig), wall_offset_ns_(clock.wallNow() - clock.now()) {}

  /// The stamps by which frames come step with the wall clock, as the rig's script says.
  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  bool down() const noexcept override { return downBuses() != 0; }
  can::BusSet downBuses() const noexcept override {
    return static_cast<can::BusSet>(errors_.wasOff() | rig_.interfacesDown());
  }
  can::BusStatistics statistics() const noexcept override;
  can::BusStatistics statisticsOf(std::size_t bus) const noexcept override { return statistics_[bus]; }

 private:
  Rig& rig_;
  std::int64_t wall_offset_ns_;
  can::ArrivalClock arrivals_;
  can::BusCounters statistics_;
  can::ErrorMonitor errors_;
};

}  // namespace patella::sim
