#include "drivers/canopen/sdo_client.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "drivers/canopen/frame_wait.hpp"
#include "drivers/canopen/hexadecimal.hpp"
#include "drivers/canopen/network_frames.hpp"

namespace patella::canopen {
namespace {

constexpr double kTimeout_s = 0.5;
constexpr int kTries = 3;
constexpr std::size_t kLongestAnswer = 256;

constexpr std::uint32_t kNoObject = 0x06020000;
constexpr std::uint32_t kNoSubIndex = 0x06090011;
constexpr std::uint32_t kTimedOut = 0x05040000;

/// CiA 301, table of abort codes.
constexpr std::array<std::pair<std::uint32_t, std::string_view>, 31> kAborts{
    {{0x05030000, "toggle bit not alternated"},
     {kTimedOut, "SDO protocol timed out"},
     {0x05040001, "command specifier not valid or unknown"},
     {0x05040002, "invalid block size"},
     {0x05040003, "invalid sequence number"},
     {0x05040004, "CRC error"},
     {0x05040005, "out of memory"},
     {0x06010000, "unsupported access to an object"},
     {0x06010001, "attempt to read a write-only object"},
     {0x06010002, "attempt to write a read-only object"},
     {kNoObject, "object does not exist in the object dictionary"},
     {0x06040041, "object cannot be mapped to the PDO"},
     {0x06040042, "mapped objects would exceed the length of the PDO"},
     {0x06040043, "general parameter incompatibility"},
     {0x06040047, "general internal incompatibility in the device"},
     {0x06060000, "access failed due to a hardware error"},
     {0x06070010, "data type or length does not match"},
     {0x06070012, "data type does not match, length too high"},
     {0x06070013, "data type does not match, length too low"},
     {kNoSubIndex, "sub-index does not exist"},
     {0x06090030, "value out of range"},
     {0x06090031, "value too high"},
     {0x06090032, "value too low"},
     {0x06090036, "maximum is less than minimum"},
     {0x060A0023, "resource not available"},
     {0x08000000, "general error"},
     {0x08000020, "data cannot be transferred or stored"},
     {0x08000021, "data cannot be transferred because of local control"},
     {0x08000022, "data cannot be transferred in the present state of the device"},
     {0x08000023, "no object dictionary is present"},
     {0x08000024, "no data available"}}};

}  // namespace

std::string_view abortText(std::uint32_t code) noexcept {
  const auto* found = std::find_if(kAborts.begin(), kAborts.end(),
                                   [code](const auto& candidate) { return candidate.first == code; });
  return found == kAborts.end() ? "unknown code" : found->second;
}

std::string objectName(std::uint16_t index, std::uint8_t sub) {
  return hexadecimal(index, 4) + (sub == 0 ? "" : ":" + std::to_string(sub));
}

SdoAbort::SdoAbort(const std::string& where, std::uint32_t code)
    : NodeError(where + "aborted with " + hexadecimal(code, 8) + ", " + std::string(abortText(code))),
      code_(code) {}

bool SdoAbort::absent() const noexcept {
  return code_ == kNoObject || code_ == kNoSubIndex;
}

std::string SdoClient::where(std::uint16_t index, std::uint8_t sub) const {
  return "node " + std::to_string(node_) + ": " + objectName(index, sub) + ": ";
}

void SdoClient::fail(std::uint16_t index, std::uint8_t sub, const std::string& problem) const {
  throw NodeError(where(index, sub) + problem);
}

can::Frame SdoClient::request(unsigned command, std::uint16_t index, std::uint8_t sub) const noexcept {
  can::Frame frame;
  frame.id = sdoRequestId(node_);
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(command);
  writeLittleEndian(frame, 1, index, 2);
  frame.data[3] = sub;
  return frame;
}

void SdoClient::abort(std::uint16_t index, std::uint8_t sub) noexcept {
  constexpr unsigned kAbort = 0x80;
  can::Frame frame = request(kAbort, index, sub);
  writeLittleEndian(frame, 4, kTimedOut, 4);
  bus_.send(frame, clock_.now());
}

can::Frame SdoClient::ask(const can::Frame& request, std::uint16_t index, std::uint8_t sub,
                          const Expected& expected, int tries) {
  constexpr unsigned kAborted = 0x80;
  can::Frame answer;
  const auto take = [&](const can::Frame& frame) {
    if (!isStandard(frame) || frame.id != sdoAnswerId(node_) || frame.length != 8) {
      return false;
    }
    const bool named = readLittleEndian(frame, 1, 2) == index && frame.data[3] == sub;
    const bool aborted = frame.data[0] == kAborted && named;
    // Any other is the answer to a request that was given up.
    if (!aborted && ((frame.data[0] & expected.mask) != expected.value || (expected.names_entry && !named))) {
      return false;
    }
    answer = frame;
    return true;
  };
  bool sent = false;
  for (int i = 0; i < tries; ++i) {
    can::Frame frame = request;
    const can::SendResult result = bus_.send(frame, clock_.now());
    if (result == can::SendResult::kDown) {
      fail(index, sub, "the interface is down");
    }
    sent = sent || result == can::SendResult::kSent;
    if (waitForFrame(bus_, clock_, kTimeout_s, take)) {
      if (answer.data[0] == kAborted) {
        throw SdoAbort(where(index, sub), readLittleEndian(answer, 4, 4));
      }
      return answer;
    }
  }
  abort(index, sub);
  fail(index, sub,
       sent ? "no answer within 0.5 s, asked " + std::to_string(tries) +
                  " times; expected a node that is on, " + "has this number and the bus's bit rate"
            : "the request could not be sent: nobody acknowledges on the bus");
}

std::vector<std::uint8_t> SdoClient::read(std::uint16_t index, std::uint8_t sub) {
  constexpr unsigned kUpload = 0x40;
  constexpr unsigned kExpedited = 0x02;
  constexpr unsigned kSizeStated = 0x01;
  const can::Frame answer = ask(request(kUpload, index, sub), index, sub, {0xE0, 0x40, true}, kTries);
  if ((answer.data[0] & kExpedited) == 0) {
    const std::uint32_t size = (answer.data[0] & kSizeStated) != 0 ? readLittleEndian(answer, 4, 4) : 0;
    if (size > kLongestAnswer) {
      abort(index, sub);
      fail(
          index, sub,
          "answer of " + std::to_string(size) + " bytes, expected at most " + std::to_string(kLongestAnswer));
    }
    return readSegments(index, sub);
  }
  // Without a stated size (42h) all four bytes count; the reader knows how many the entry has.
  const std::size_t unused = (answer.data[0] & kSizeStated) != 0 ? answer.data[0] >> 2U & 3U : 0;
  return {answer.data.begin() + 4, answer.data.begin() + 8 - static_cast<std::ptrdiff_t>(unused)};
}

std::vector<std::uint8_t> SdoClient::readSegments(std::uint16_t index, std::uint8_t sub) {
  constexpr unsigned kUploadSegment = 0x60;
  constexpr unsigned kToggle = 0x10;
  constexpr unsigned kLast = 0x01;
  std::vector<std::uint8_t> data;
  unsigned toggle = 0;
  while (true) {
    const can::Frame segment = request(kUploadSegment | toggle, 0, 0);
    // A segment that is asked for twice would be the next one: one try.
    const can::Frame answer = ask(segment, index, sub, {0xF0, toggle, false}, 1);
    const std::size_t used = 7U - (answer.data[0] >> 1U & 7U);
    data.insert(data.end(), answer.data.begin() + 1,
                answer.data.begin() + 1 + static_cast<std::ptrdiff_t>(used));
    if ((answer.data[0] & kLast) != 0) {
      return data;
    }
    if (data.size() > kLongestAnswer) {
      abort(index, sub);
      fail(index, sub, "answer of more than " + std::to_string(kLongestAnswer) + " bytes");
    }
    toggle ^= kToggle;
  }
}

std::uint32_t SdoClient::number(std::uint16_t index, std::uint8_t sub, int bytes) {
  const std::vector<std::uint8_t> data = read(index, sub);
  if (data.size() < static_cast<std::size_t>(bytes) || data.size() > 4) {
    fail(
        index, sub,
        "answer of " + std::to_string(data.size()) + " bytes, expected a number of " + std::to_string(bytes));
  }
  std::uint32_t value = 0;
  for (int i = bytes - 1; i >= 0; --i) {
    value = value << 8U | data[static_cast<std::size_t>(i)];
  }
  return value;
}

void SdoClient::write(const ObjectValue& object) {
  ask(downloadFrame(node_, object), object.index, object.sub, {0xE0, 0x60, true}, kTries);
}

}  // namespace patella::canopen
