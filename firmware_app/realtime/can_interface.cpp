#include "firmware_app/realtime/can_interface.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace patella::app {

namespace {

class Socket {
 public:
  Socket(int domain, int type, int protocol) noexcept : fd_(socket(domain, type | SOCK_CLOEXEC, protocol)) {}
  ~Socket() {
    if (fd_ >= 0) {
      close(fd_);
    }
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const noexcept { return fd_; }

 private:
  int fd_;
};

[[noreturn]] void fail(const std::string& name) {
  throw std::runtime_error("CAN interface " + name +
                           ": cannot ask the kernel: " + std::generic_category().message(errno));
}

/// Calls visit(type, payload, bytes) for each attribute of a netlink attribute list.
template <typename Visit>
void forEachAttribute(const void* first, std::size_t bytes, const Visit& visit) {
  const auto* at = static_cast<const char*>(first);
  while (bytes >= sizeof(rtattr)) {
    rtattr header{};
    std::memcpy(&header, at, sizeof header);
    if (header.rta_len < sizeof header || header.rta_len > bytes) {
      return;
    }
    visit(header.rta_type & NLA_TYPE_MASK, at + RTA_LENGTH(0), header.rta_len - RTA_LENGTH(0));
    const std::size_t step = RTA_ALIGN(header.rta_len);
    if (step >= bytes) {
      return;
    }
    at += step;
    bytes -= step;
  }
}

template <typename T>
T valueOf(const char* payload, std::size_t bytes) {
  T value{};
  std::memcpy(&value, payload, bytes < sizeof value ? bytes : sizeof value);
  return value;
}

void readControllerAttribute(CanInterface& found, int type, const char* payload, std::size_t bytes) {
  if (type == IFLA_CAN_BITTIMING) {
    found.bitrate = valueOf<can_bittiming>(payload, bytes).bitrate;
  } else if (type == IFLA_CAN_RESTART_MS) {
    found.restart_ms = valueOf<std::uint32_t>(payload, bytes);
  } else if (type == IFLA_CAN_STATE) {
    found.state = valueOf<std::uint32_t>(payload, bytes);
  }
}

void readLinkAttribute(CanInterface& found, int type, const char* payload, std::size_t bytes) {
  if (type == IFLA_TXQLEN) {
    found.txqueuelen = valueOf<std::uint32_t>(payload, bytes);
  } else if (type == IFLA_MTU) {
    found.fd = valueOf<std::uint32_t>(payload, bytes) >= CANFD_MTU;
  } else if (type == IFLA_LINKINFO) {
    forEachAttribute(payload, bytes, [&](int info, const char* inner, std::size_t length) {
      if (info == IFLA_INFO_KIND) {
        found.kind.assign(inner, strnlen(inner, length));
      } else if (info == IFLA_INFO_DATA && found.kind == "can") {
        forEachAttribute(inner, length, [&](int item, const char* data, std::size_t size) {
          readControllerAttribute(found, item, data, size);
        });
      }
    });
  }
}

}  // namespace

std::optional<CanInterface> queryCanInterface(const std::string& name) {
  const Socket netlink(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
  if (name.empty() || name.size() >= IFNAMSIZ) {
    return std::nullopt;
  }
  struct {
    nlmsghdr header;
    ifinfomsg link;
    rtattr name_header;
    std::array<char, IFNAMSIZ> name;
  } request{};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.name_header.rta_type = IFLA_IFNAME;
  request.name_header.rta_len = static_cast<unsigned short>(RTA_LENGTH(request.name.size()));
  name.copy(request.name.data(), name.size());
  if (netlink.fd() < 0 || send(netlink.fd(), &request, sizeof request, 0) < 0) {
    fail(name);
  }
  alignas(nlmsghdr) std::array<char, 16384> answer{};
  const ssize_t received = recv(netlink.fd(), answer.data(), answer.size(), 0);
  if (received < 0) {
    fail(name);
  }
  const auto* const header = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (!NLMSG_OK(header, static_cast<std::size_t>(received)) || header->nlmsg_type != RTM_NEWLINK) {
    return std::nullopt;  // an error message: no such interface
  }
  const auto* const link = static_cast<const ifinfomsg*>(NLMSG_DATA(header));
  CanInterface found;
  found.up = (link->ifi_flags & IFF_UP) != 0;
  found.can = link->ifi_type == ARPHRD_CAN;
  forEachAttribute(IFLA_RTA(link), IFLA_PAYLOAD(header),
                   [&](int type, const char* payload, std::size_t bytes) {
                     readLinkAttribute(found, type, payload, bytes);
                   });
  found.fd = found.fd && found.can;
  return found;
}

void setCanInterfaceUp(const std::string& name, bool up) {
  const Socket socket(PF_CAN, SOCK_RAW, CAN_RAW);
  ifreq request{};
  name.copy(request.ifr_name, IFNAMSIZ - 1);
  bool done = socket.fd() >= 0 && ioctl(socket.fd(), SIOCGIFFLAGS, &request) == 0;
  if (done) {
    constexpr int kUp = IFF_UP;
    request.ifr_flags = static_cast<short>(up ? request.ifr_flags | kUp : request.ifr_flags & ~kUp);
    done = ioctl(socket.fd(), SIOCSIFFLAGS, &request) == 0;
  }
  if (!done) {
    throw std::runtime_error("CAN interface " + name + ": cannot be " + (up ? "brought up" : "taken down") +
                             ": " + std::generic_category().message(errno));
  }
}

void requireVirtual(const std::string& name) {
  const std::optional<CanInterface> found = queryCanInterface(name);
  if (!found || found->kind != "vcan") {
    throw std::invalid_argument("loop.rehearsal = true on CAN interface " + name +
                                ", expected a virtual one (vcan): a rehearsal moves no motor");
  }
}

bool kernelHasCan() noexcept {
  return Socket(PF_CAN, SOCK_RAW, CAN_RAW).fd() >= 0;
}

}  // namespace patella::app
