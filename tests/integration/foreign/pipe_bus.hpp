// A bus whose other end is a process: frames as lines in the notation of candump, on its standard input and
// output.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

#include "drivers/can/bus.hpp"
#include "sim/rig_messages.hpp"

namespace patella::test {

class PipeBus final : public can::Bus {
 public:
  /// Starts the program. The database gives the operator's frame. Throws std::runtime_error.
  PipeBus(const std::vector<std::string>& command, const can::Database& database);
  ~PipeBus() override;
  PipeBus(const PipeBus&) = delete;
  PipeBus& operator=(const PipeBus&) = delete;

  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

  /// Ends the program's input, and waits until it ends. Returns its exit status.
  int close() noexcept;
  /// From now on an operator is there, who holds enable or not.
  void operate(bool enable) noexcept {
    operated_ = true;
    enable_ = enable;
  }
  /// Everything that went over the bus, in its order.
  const std::vector<can::Frame>& log() const noexcept { return log_; }

 private:
  void note(const can::Frame& frame) noexcept;

  sim::OutgoingMessage operator_;
  pid_t child_ = -1;
  int to_ = -1;
  int from_ = -1;
  bool operated_ = false;
  bool enable_ = false;
  std::string rest_;
  std::vector<can::Frame> log_;
};

}  // namespace patella::test
