#include "firmware_app/formats/mcap_reader.hpp"

#include <array>
#include <system_error>

#include <zstd.h>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/formats/little_endian.hpp"
#include "firmware_app/formats/mcap_crc.hpp"

namespace patella::formats {
namespace {

constexpr std::uint64_t kLargestChunk = 256'000'000;
constexpr std::uint64_t kLargestRecord = 1'000'000'000;  // attached recordings

McapSchemaRecord schemaOf(ByteReader reader) {
  McapSchemaRecord record;
  record.id = reader.number<std::uint16_t>();
  record.schema.name = reader.text();
  record.schema.encoding = reader.text();
  record.schema.text = reader.text();
  return record;
}

McapChannelRecord channelOf(ByteReader reader) {
  McapChannelRecord record;
  record.id = reader.number<std::uint16_t>();
  record.channel.schema = reader.number<std::uint16_t>();
  record.channel.topic = reader.text();
  record.channel.encoding = reader.text();
  record.channel.metadata = reader.map();
  return record;
}

McapMessage messageOf(ByteReader reader) {
  McapMessage message;
  message.channel = reader.number<std::uint16_t>();
  reader.number<std::uint32_t>();  // its number in the channel
  message.log_ns = reader.number<std::uint64_t>();
  message.publish_ns = reader.number<std::uint64_t>();
  message.data = reader.rest();
  return message;
}

McapAttachment attachmentOf(std::string_view content) {
  ByteReader reader(content);
  McapAttachment attachment;
  attachment.time_ns = reader.number<std::uint64_t>();
  reader.number<std::uint64_t>();  // when it was made
  attachment.name = reader.text();
  attachment.media_type = reader.text();
  attachment.data = reader.take(reader.number<std::uint64_t>());
  const auto crc = reader.number<std::uint32_t>();
  if (crc != 0 && crc != mcapCrc(content.substr(0, content.size() - sizeof(crc)))) {
    throw std::invalid_argument("an attachment '" + attachment.name + "' contradicts its checksum");
  }
  return attachment;
}

McapMetadata metadataOf(ByteReader reader) {
  McapMetadata metadata;
  metadata.name = reader.text();
  metadata.values = reader.map();
  return metadata;
}

}  // namespace

struct McapReader::Decompressor {
  Decompressor() : context(ZSTD_createDCtx()) {
    if (context == nullptr) {
      throw std::bad_alloc();
    }
  }
  ~Decompressor() { ZSTD_freeDCtx(context); }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;

  ZSTD_DCtx* context;
};

McapReader::McapReader(const std::filesystem::path& path)
    : name_(path.string()), decompressor_(std::make_unique<Decompressor>()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw app::FileError(name_ + ": is no file that can be read, expected a recording in MCAP");
  }
  stream_.open(path, std::ios::binary);
  size_ = std::filesystem::file_size(path, error);
  std::array<char, kMcapMagic.size()> magic{};
  stream_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (std::string_view(magic.data(), static_cast<std::size_t>(stream_.gcount())) != kMcapMagic) {
    throw app::FileError(name_ + ": does not begin as an MCAP file does");
  }
  at_ = kMcapMagic.size();
}

McapReader::~McapReader() = default;

void McapReader::fail(const std::string& words) const {
  throw app::FileError(name_ + ": record at byte " + std::to_string(record_) + ": " + words);
}

// Reads a record of the file into content_; false where it is not whole.
bool McapReader::nextOfFile(McapOpcode& opcode) {
  record_ = at_;
  std::array<char, kMcapRecordHead> head{};
  if (size_ - at_ < head.size() || !stream_.read(head.data(), head.size())) {
    return false;
  }
  ByteReader reader({head.data(), head.size()});
  opcode = static_cast<McapOpcode>(reader.number<std::uint8_t>());
  const auto length = reader.number<std::uint64_t>();
  if (length > size_ - at_ - head.size()) {
    return false;
  }
  if (length > kLargestRecord) {
    fail(std::to_string(length) + " bytes, expected at most " + std::to_string(kLargestRecord));
  }
  content_.resize(static_cast<std::size_t>(length));
  if (!stream_.read(content_.data(), static_cast<std::streamsize>(length))) {
    return false;
  }
  at_ += head.size() + length;
  return true;
}

void McapReader::openChunk() {
  ByteReader reader(content_);
  reader.number<std::uint64_t>();  // first and last time of its messages
  reader.number<std::uint64_t>();
  const auto size = reader.number<std::uint64_t>();
  const auto crc = reader.number<std::uint32_t>();
  const std::string compression(reader.text());
  const std::string_view records = reader.take(reader.number<std::uint64_t>());
  if (size > kLargestChunk) {
    fail("a chunk of " + std::to_string(size) + " bytes, expected at most " + std::to_string(kLargestChunk));
  }
  if (compression.empty()) {
    chunk_ = records;
  } else if (compression == "zstd") {
    chunk_.resize(static_cast<std::size_t>(size));
    const std::size_t got = ZSTD_decompressDCtx(decompressor_->context, chunk_.data(), chunk_.size(),
                                                records.data(), records.size());
    if (ZSTD_isError(got) != 0) {
      fail(std::string("a chunk cannot be decompressed: ") + ZSTD_getErrorName(got));
    }
    chunk_.resize(got);
  } else {
    fail("compression '" + compression + "', expected zstd or none");
  }
  if (chunk_.size() != size || (crc != 0 && crc != mcapCrc(chunk_))) {
    fail("a chunk contradicts its length or its checksum");
  }
  chunk_at_ = 0;
}

bool McapReader::nextOfChunk(McapOpcode& opcode, std::string_view& content) {
  if (chunk_at_ >= chunk_.size()) {
    return false;
  }
  ByteReader reader(std::string_view(chunk_).substr(chunk_at_));
  opcode = static_cast<McapOpcode>(reader.number<std::uint8_t>());
  content = reader.take(reader.number<std::uint64_t>());
  chunk_at_ = chunk_.size() - reader.rest().size();
  return true;
}

bool McapReader::next(McapRecord& record) {
  try {
    while (!ended_) {
      McapOpcode opcode{};
      std::string_view content;
      const bool in_chunk = nextOfChunk(opcode, content);
      if (!in_chunk) {
        if (!nextOfFile(opcode)) {
          cut_ = ended_ = true;
          return false;
        }
        content = content_;
      }
      switch (opcode) {
        case McapOpcode::kMessage:
          record = messageOf(ByteReader(content));
          return true;
        case McapOpcode::kSchema:
          record = schemaOf(ByteReader(content));
          return true;
        case McapOpcode::kChannel:
          record = channelOf(ByteReader(content));
          return true;
        case McapOpcode::kAttachment:
          record = attachmentOf(content);
          return true;
        case McapOpcode::kMetadata:
          record = metadataOf(ByteReader(content));
          return true;
        case McapOpcode::kChunk:
          if (in_chunk) {
            fail("a chunk within a chunk");
          }
          openChunk();
          break;
        case McapOpcode::kDataEnd:
          ended_ = true;
          break;
        default:
          break;  // indices, and records of later versions
      }
    }
  } catch (const std::invalid_argument& error) {
    fail(error.what());
  }
  return false;
}

bool isMcap(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::array<char, kMcapMagic.size()> magic{};
  stream.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  return std::string_view(magic.data(), static_cast<std::size_t>(stream.gcount())) == kMcapMagic;
}

}  // namespace patella::formats
