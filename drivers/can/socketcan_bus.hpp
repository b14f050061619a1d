// A CAN interface of the kernel (SocketCAN), as documented in Documentation/networking/can.rst.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/can/bus.hpp"

namespace patella::can {

struct SocketCanOptions {
  /// Bytes that frames under way may occupy, before the kernel's bookkeeping; the kernel raises it to its
  /// smallest. Kept small: what queues here would come out as old torque commands.
  int send_buffer_bytes = 2048;
  /// Bytes for frames not yet taken; 0 leaves the kernel's default (some 200 frames). Limited by
  /// net.core.rmem_max.
  int receive_buffer_bytes = 0;
  bool require_fd = false;  ///< refuse an interface that cannot send CAN FD frames
};

/// One raw socket for both directions. Own frames come back from the kernel when they have been on the wire,
/// flagged Frame::own and stamped by the same clock as the others, so that their wall stamps can be compared.
/// Error reports are delivered as frames with Frame::error, and followed: down() is true from a bus-off until
/// the controller's restart or a frame from another node. While bus-off nothing is sent. An interface that
/// goes down is served again once it is up; one that is removed stays down.
class SocketCanBus final : public Bus {
 public:
  /// Throws std::runtime_error saying what is wrong with which interface: kernel without CAN, no such
  /// interface, not a CAN interface, down, not permitted.
  explicit SocketCanBus(const std::string& interface, const SocketCanOptions& options = {});
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  void discardPending() noexcept override;
  std::size_t receive(std::span<Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  SendResult send(Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  bool down() const noexcept override;
  BusStatistics statistics() const noexcept override;

  bool flexibleDataRate() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patella::can
