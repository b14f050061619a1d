#include "drivers/can/socketcan_bus.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/can/arrival_clock.hpp"
#include "drivers/can/error_monitor.hpp"
#include "drivers/clock/kernel_time.hpp"
#include "drivers/kernel_call.hpp"

namespace patella::can {
namespace {

constexpr std::size_t kBatch = 64;
constexpr std::uint8_t kFdFrameFlag = 0x04;  // CANFD_FDF, which headers before 5.14 lack

static_assert(kErrorTxTimeout == CAN_ERR_TX_TIMEOUT && kErrorController == CAN_ERR_CRTL &&
              kErrorBusOff == CAN_ERR_BUSOFF && kErrorRestarted == CAN_ERR_RESTARTED);

[[noreturn]] void fail(const std::string& interface, const std::string& why, int error = 0) {
  throw std::runtime_error("CAN interface '" + interface + "': " + why +
                           (error == 0 ? "" : " (" + std::generic_category().message(error) + ")"));
}

struct SocketHandle {
  int fd = -1;
  ~SocketHandle() {
    if (fd >= 0)
      close(fd);
  }
};

int openSocket(const std::string& interface) {
  const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd >= 0)
    return fd;
  switch (errno) {
    case EAFNOSUPPORT:
      fail(interface, "this kernel has no CAN support; load the module 'can'", errno);
    case EPROTONOSUPPORT:
      fail(interface, "this kernel has no raw CAN sockets; load the module 'can_raw'", errno);
    case EPERM:
    case EACCES:
      fail(interface, "not permitted to open a CAN socket", errno);
    default:
      fail(interface, "cannot open a CAN socket", errno);
  }
}

ifreq request(const std::string& interface) {
  ifreq result{};
  std::copy_n(interface.begin(), std::min<std::size_t>(interface.size(), IFNAMSIZ - 1), result.ifr_name);
  return result;
}

template <typename T>
void setOption(int fd, const std::string& interface, int level, int option, const T& value,
               const char* name) {
  if (setsockopt(fd, level, option, &value, sizeof(value)) != 0) {
    fail(interface, std::string("cannot set ") + name, errno);
  }
}

void pack(const Frame& frame, canfd_frame& out) noexcept {
  out = canfd_frame{};
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U) |
               (frame.error ? CAN_ERR_FLAG : 0U);
  out.len = std::min<std::uint8_t>(frame.length, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  if (frame.fd) {
    out.flags = static_cast<std::uint8_t>(kFdFrameFlag | (frame.bit_rate_switch ? CANFD_BRS : 0));
  }
  std::copy_n(frame.data.begin(), out.len, out.data);
}

void unpack(const canfd_frame& in, bool fd, Frame& frame) noexcept {
  frame = Frame{};
  frame.error = (in.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (in.can_id & CAN_RTR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.fd = fd;
  frame.bit_rate_switch = fd && (in.flags & CANFD_BRS) != 0;
  frame.length = std::min<std::uint8_t>(in.len, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::copy_n(in.data, frame.length, frame.data.begin());
}

}  // namespace

struct SocketCanBus::State {
  SocketHandle socket;
  bool fd_capable = false;

  ArrivalClock arrivals;
  std::int64_t wall_offset_ns =
      readKernelClock(CLOCK_REALTIME) - readKernelClock(CLOCK_MONOTONIC);  ///< when the run began
  ErrorMonitor errors;
  BusStatistics statistics;
  bool interface_down = false;
  std::uint32_t overflow = 0;  ///< the kernel's running count of frames that the socket had no room for
  bool overflow_known = true;  ///< false: what the next frame reports is where counting starts

  // One batch of recvmmsg(2), laid out once.
  struct alignas(cmsghdr) Control {
    std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> bytes;
  };
  std::array<canfd_frame, kBatch> buffers{};
  std::array<Control, kBatch> controls{};
  std::array<iovec, kBatch> vectors{};
  std::array<mmsghdr, kBatch> messages{};

  State();
  void configure(const std::string& interface, const SocketCanOptions& options);
  void attach(const std::string& interface, const SocketCanOptions& options);
  std::size_t receiveBatch(std::span<Frame> frames, std::int64_t now_ns) noexcept;
  void takeControl(msghdr& header, Frame& frame) noexcept;
};

SocketCanBus::State::State() {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors[i] = {&buffers[i], sizeof(canfd_frame)};
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_control = controls[i].bytes.data();
  }
}

void SocketCanBus::State::configure(const std::string& interface, const SocketCanOptions& options) {
  constexpr int kOn = 1;
  constexpr can_err_mask_t kErrors = kErrorsOfInterest;
  const int fd = socket.fd;
  setOption(fd, interface, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, kOn, "CAN_RAW_FD_FRAMES");
  setOption(fd, interface, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrors, "CAN_RAW_ERR_FILTER");
  setOption(fd, interface, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, kOn, "CAN_RAW_RECV_OWN_MSGS");
  setOption(fd, interface, SOL_SOCKET, SO_RXQ_OVFL, kOn, "SO_RXQ_OVFL");
  setOption(fd, interface, SOL_SOCKET, SO_TIMESTAMPNS, kOn, "SO_TIMESTAMPNS");
  setOption(fd, interface, SOL_SOCKET, SO_SNDBUF, options.send_buffer_bytes, "SO_SNDBUF");
  if (options.receive_buffer_bytes > 0) {
    setOption(fd, interface, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes, "SO_RCVBUF");
  }
}

void SocketCanBus::State::attach(const std::string& interface, const SocketCanOptions& options) {
  const unsigned index = interface.size() < IFNAMSIZ ? if_nametoindex(interface.c_str()) : 0;
  if (index == 0)
    fail(interface, "no such interface");
  ifreq query = request(interface);
  if (ioctl(socket.fd, SIOCGIFHWADDR, &query) != 0)
    fail(interface, "cannot be asked for its type", errno);
  if (query.ifr_hwaddr.sa_family != ARPHRD_CAN)
    fail(interface, "not a CAN interface");
  query = request(interface);
  if (ioctl(socket.fd, SIOCGIFFLAGS, &query) != 0)
    fail(interface, "cannot be asked for its state", errno);
  if ((query.ifr_flags & IFF_UP) == 0) {
    fail(interface, "is down; bring it up with 'ip link set " + interface + " up'");
  }
  query = request(interface);
  if (ioctl(socket.fd, SIOCGIFMTU, &query) != 0)
    fail(interface, "cannot be asked for its frame size", errno);
  fd_capable = query.ifr_mtu >= static_cast<int>(CANFD_MTU);
  if (options.require_fd && !fd_capable)
    fail(interface, "carries classic frames only, expected CAN FD, which messages of the bus map have");

  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (bind(socket.fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    fail(interface, errno == EPERM || errno == EACCES ? "not permitted to bind" : "cannot bind", errno);
  }
}

SocketCanBus::SocketCanBus(const std::string& interface, const SocketCanOptions& options)
    : state_(std::make_unique<State>()) {
  state_->socket.fd = openSocket(interface);
  state_->configure(interface, options);
  state_->attach(interface, options);
}

SocketCanBus::~SocketCanBus() = default;

void SocketCanBus::State::takeControl(msghdr& header, Frame& frame) noexcept {
  for (cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr;
       control = CMSG_NXTHDR(&header, control)) {
    if (control->cmsg_level != SOL_SOCKET)
      continue;
    if (control->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(control), sizeof(stamp));
      frame.wall_ns = toNanoseconds(stamp);
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(control), sizeof(total));
      // The difference stays right when 32 bits wrap.
      statistics.receive_dropped += overflow_known ? total - overflow : 0U;
      overflow = total;
      overflow_known = true;
    }
  }
}

std::size_t SocketCanBus::State::receiveBatch(std::span<Frame> frames, std::int64_t now_ns) noexcept {
  const std::size_t wanted = std::min(frames.size(), kBatch);
  for (std::size_t i = 0; i < wanted; ++i) {
    messages[i].msg_hdr.msg_controllen = sizeof(Control);
    messages[i].msg_hdr.msg_flags = 0;
  }
  int received = 0;
  {
    const KernelCall never_waits;
    received = recvmmsg(socket.fd, messages.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
  }
  if (received < 0) {
    // Told once when the interface goes; what was queued can still be read.
    if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO)
      interface_down = true;
    return 0;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(received); ++i) {
    Frame& frame = frames[i];
    unpack(buffers[i], messages[i].msg_len == CANFD_MTU, frame);
    frame.own = (messages[i].msg_hdr.msg_flags & MSG_CONFIRM) != 0;
    takeControl(messages[i].msg_hdr, frame);
    frame.monotonic_ns = now_ns;
    arrivals.date(frame, wall_offset_ns);
    errors.observe(frame, statistics);
    if (frame.error)
      continue;
    interface_down = false;
    if (!frame.own)
      ++statistics.frames_received;
  }
  return static_cast<std::size_t>(received);
}

void SocketCanBus::discardPending() noexcept {
  std::array<Frame, kBatch> discarded;
  while (receive(discarded, 0) == discarded.size()) {
  }
  state_->statistics = {};
  state_->overflow_known = false;
  state_->arrivals = {};
  state_->wall_offset_ns = readKernelClock(CLOCK_REALTIME) - readKernelClock(CLOCK_MONOTONIC);
}

std::size_t SocketCanBus::receive(std::span<Frame> frames, std::int64_t now_ns) noexcept {
  state_->errors.beginReceive();
  {
    const KernelCall never_waits;
    state_->arrivals.begin(readKernelClock(CLOCK_MONOTONIC), readKernelClock(CLOCK_REALTIME));
  }
  std::size_t count = 0;
  while (count < frames.size()) {
    const bool was_down = state_->interface_down;
    const std::size_t wanted = std::min(frames.size() - count, kBatch);
    const std::size_t got = state_->receiveBatch(frames.subspan(count), now_ns);
    count += got;
    // The report of an interface that went down may stand before frames.
    const bool just_went_down = got == 0 && state_->interface_down && !was_down;
    if (got < wanted && !just_went_down) {
      state_->arrivals.emptied();
      break;
    }
  }
  return count;
}

SendResult SocketCanBus::send(Frame& frame, std::int64_t now_ns) noexcept {
  State& state = *state_;
  if (state.errors.busOff()) {
    ++state.statistics.send_failed;
    return SendResult::kDown;
  }
  canfd_frame wire;
  pack(frame, wire);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  ssize_t sent = 0;
  int error = 0;
  std::int64_t sent_ns = 0;
  {
    const KernelCall never_waits;
    sent = ::send(state.socket.fd, &wire, size, MSG_DONTWAIT);
    error = errno;
    sent_ns = readKernelClock(CLOCK_MONOTONIC);
  }
  if (sent == static_cast<ssize_t>(size)) {
    ++state.statistics.frames_sent;
    state.interface_down = false;
    frame.monotonic_ns = now_ns;
    frame.wall_ns = sent_ns + state.wall_offset_ns;
    return SendResult::kSent;
  }
  ++state.statistics.send_failed;
  if (sent < 0 && (error == ENETDOWN || error == ENODEV || error == ENXIO)) {
    state.interface_down = true;
    return SendResult::kDown;
  }
  return SendResult::kQueueFull;
}

bool SocketCanBus::down() const noexcept {
  return state_->interface_down || state_->errors.wasOff() != 0;
}

BusStatistics SocketCanBus::statistics() const noexcept {
  return state_->statistics;
}

bool SocketCanBus::flexibleDataRate() const noexcept {
  return state_->fd_capable;
}

}  // namespace patella::can
