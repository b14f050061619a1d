#include "drivers/canopen/emergency.hpp"

#include <array>

#include "drivers/canopen/hexadecimal.hpp"

namespace patella::canopen {
namespace {

struct CodeText {
  std::uint16_t mask;
  std::uint16_t code;
  std::string_view text;
};

/// The first that fits: particular codes stand before their class.
constexpr std::array<CodeText, 33> kCodes{{
    {0xFFFF, 0x2310, "continuous over current"},
    {0xFFFF, 0x2320, "short circuit"},
    {0xFFFF, 0x3210, "over voltage"},
    {0xFFFF, 0x3220, "under voltage"},
    {0xFFFF, 0x4210, "too high temperature of the device"},
    {0xFFFF, 0x4310, "too high temperature of the drive"},
    {0xFFFF, 0x7121, "motor blocked"},
    {0xFFFF, 0x7305, "incremental encoder 1"},
    {0xFFFF, 0x8110, "CAN overrun, objects lost"},
    {0xFFFF, 0x8120, "CAN in error passive mode"},
    {0xFFFF, 0x8130, "heartbeat or life guarding"},
    {0xFFFF, 0x8140, "recovered from bus off"},
    {0xFFFF, 0x8150, "collision of CAN identifiers"},
    {0xFFFF, 0x8210, "PDO not processed for its length"},
    {0xFFFF, 0x8220, "PDO too long"},
    {0xFFFF, 0x8240, "unexpected length of SYNC"},
    {0xFFFF, 0x8250, "RPDO timed out"},
    {0xFFFF, 0x8611, "following error"},
    {0xFFFF, 0x8700, "sync controller"},
    {0xFF00, 0x0000, "error reset or no error"},
    {0xFF00, 0x1000, "generic error"},
    {0xF000, 0x2000, "current"},
    {0xF000, 0x3000, "voltage"},
    {0xF000, 0x4000, "temperature"},
    {0xF000, 0x5000, "device hardware"},
    {0xF000, 0x6000, "device software"},
    {0xF000, 0x7000, "additional modules"},
    {0xFF00, 0x8100, "communication"},
    {0xFF00, 0x8200, "protocol error"},
    {0xF000, 0x8000, "monitoring"},
    {0xF000, 0x9000, "external error"},
    {0xFF00, 0xFF00, "of the maker's own"},
    {0xF000, 0xF000, "additional functions"},
}};

std::string_view stateText(std::uint16_t state) noexcept {
  constexpr std::uint16_t kStopped = 0x04;
  constexpr std::uint16_t kPreOperational = 0x7F;
  return state == kStopped ? "stopped" : state == kPreOperational ? "pre-operational" : "unknown state";
}

}  // namespace

std::string_view emergencyText(std::uint16_t code) noexcept {
  for (const CodeText& known : kCodes) {
    if ((code & known.mask) == known.code) {
      return known.text;
    }
  }
  return "unknown code";
}

std::string noticeText(const NodeNotice& notice) {
  const std::string node = "node" + std::to_string(notice.node);
  switch (notice.kind) {
    case NoticeKind::kEmergency:
      return node + "=emergency code=" + hexadecimal(notice.code, 4) +
             " register=" + hexadecimal(notice.error_register, 2) + " text=\"" +
             std::string(emergencyText(notice.code)) + "\"";
    case NoticeKind::kSilent:
      return node + "=silent text=\"no heartbeat\"";
    case NoticeKind::kBootUp:
      return node + "=boot_up text=\"it has started anew\"";
    case NoticeKind::kState:
      return node + "=state code=" + hexadecimal(notice.code, 2) + " text=\"" +
             std::string(stateText(notice.code)) + "\"";
    case NoticeKind::kNone:
      break;
  }
  return "";
}

}  // namespace patella::canopen
