// What a node says of itself in a run: emergencies, and its state in its heartbeat.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace patella::canopen {

/// Why a node is no longer what the set-up made of it.
enum class NoticeKind : std::uint8_t {
  kNone,
  kEmergency,  ///< EMCY, with code and register
  kSilent,     ///< its heartbeat is missing
  kBootUp,     ///< it has started anew
  kState,      ///< it is in another state than operational; that is the code
};

/// Of one tick and one node.
struct NodeNotice {
  NoticeKind kind = NoticeKind::kNone;
  std::uint8_t node = 0;
  std::uint8_t error_register = 0;
  std::uint16_t code = 0;
};

/// Meaning of an emergency's code after CiA 301 and 402, from the particular to its class.
std::string_view emergencyText(std::uint16_t code) noexcept;

/// For the log: `node1=emergency code=8130h register=11h text="heartbeat or life guarding"`.
std::string noticeText(const NodeNotice& notice);

}  // namespace patella::canopen
