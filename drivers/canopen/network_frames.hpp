// Frames of CiA 301 that need no object dictionary.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/can/can_frame.hpp"
#include "drivers/canopen/canopen_map.hpp"

namespace patella::canopen {

inline std::uint32_t readLittleEndian(const can::Frame& frame, std::size_t at, int bytes) noexcept {
  std::uint32_t value = 0;
  for (int i = bytes - 1; i >= 0; --i) {
    value = value << 8U | frame.data[at + static_cast<std::size_t>(i)];
  }
  return value;
}

inline void writeLittleEndian(can::Frame& frame, std::size_t at, std::uint32_t value, int bytes) noexcept {
  for (int i = 0; i < bytes; ++i) {
    frame.data[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

inline can::Frame nmtFrame(NmtCommand command, int node) noexcept {
  can::Frame frame;
  frame.id = kNmtId;
  frame.length = 2;
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = static_cast<std::uint8_t>(node);
  return frame;
}

inline can::Frame syncFrame() noexcept {
  can::Frame frame;
  frame.id = kSyncId;
  return frame;
}

inline can::Frame heartbeatFrame(int node) noexcept {
  can::Frame frame;
  frame.id = heartbeatId(node);
  frame.length = 1;
  frame.data[0] = kOperationalState;
  return frame;
}

/// Expedited download of 1, 2 or 4 bytes.
inline can::Frame downloadFrame(int node, const ObjectValue& object) noexcept {
  can::Frame frame;
  frame.id = sdoRequestId(node);
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(0x23U | static_cast<unsigned>(4 - object.bytes) << 2U);
  writeLittleEndian(frame, 1, object.index, 2);
  frame.data[3] = object.sub;
  writeLittleEndian(frame, 4, object.value, object.bytes);
  return frame;
}

/// A data frame of 11 bits that somebody else sent.
inline bool isStandard(const can::Frame& frame) noexcept {
  return !frame.own && !frame.error && !frame.remote && !frame.extended;
}

}  // namespace patella::canopen
