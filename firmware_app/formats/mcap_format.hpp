// What writer and reader of MCAP files share (https://mcap.dev/spec): numbers are little-endian, a record is
// an opcode, the length of its content as 64 bits, and the content.
#pragma once

#include <cstdint>
#include <string_view>

namespace patella::formats {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kMcapRecordHead = 9;  ///< bytes of opcode and length

enum class McapOpcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

}  // namespace patella::formats
