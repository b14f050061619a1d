// What emergencies are called in the log.
#include "drivers/canopen/emergency.hpp"

#include <doctest/doctest.h>

using namespace patella::canopen;

TEST_CASE("a code has its own text, or that of its class") {
  CHECK(emergencyText(0x0000) == "error reset or no error");
  CHECK(emergencyText(0x8130) == "heartbeat or life guarding");
  CHECK(emergencyText(0x8611) == "following error");
  CHECK(emergencyText(0x8612) == "monitoring");
  CHECK(emergencyText(0x2310) == "continuous over current");
  CHECK(emergencyText(0x2311) == "current");
  CHECK(emergencyText(0x5441) == "device hardware");
  CHECK(emergencyText(0xFF01) == "of the maker's own");
  CHECK(emergencyText(0xF001) == "additional functions");
  CHECK(emergencyText(0xA000) == "unknown code");
}

TEST_CASE("notices for the log name node, code and text") {
  CHECK(noticeText({NoticeKind::kEmergency, 3, 0x11, 0x8130}) ==
        "node3=emergency code=8130h register=11h text=\"heartbeat or life guarding\"");
  CHECK(noticeText({NoticeKind::kSilent, 1, 0, 0}) == "node1=silent text=\"no heartbeat\"");
  CHECK(noticeText({NoticeKind::kBootUp, 2, 0, 0}) == "node2=boot_up text=\"it has started anew\"");
  CHECK(noticeText({NoticeKind::kState, 2, 0, 0x7F}) == "node2=state code=7Fh text=\"pre-operational\"");
  CHECK(noticeText({}).empty());
}
