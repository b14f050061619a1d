// Writes MCAP files: zstd chunks with an index of their messages, attachments, metadata, a summary, and
// checksums of all of it. Nothing but its arguments enters the file, so that the same calls give the same
// bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware_app/formats/mcap_format.hpp"

namespace patella::formats {

struct McapSchema {
  std::string name;      ///< of the type, e.g. "sensor_msgs/msg/JointState"
  std::string encoding;  ///< "ros2msg"
  std::string text;
};

struct McapChannel {
  std::uint16_t schema = 0;  ///< its id
  std::string topic;
  std::string encoding;  ///< "cdr"
  std::map<std::string, std::string> metadata;
};

struct McapAttachment {
  std::uint64_t time_ns = 0;
  std::string name;
  std::string media_type;
  std::string data;
};

struct McapMetadata {
  std::string name;
  std::map<std::string, std::string> values;
};

class McapWriter {
 public:
  /// Takes the bytes of the file in their order.
  using Sink = std::function<void(std::string_view)>;

  /// Begins the file; `library` is who writes it. A chunk ends when it holds a mebibyte, or a second of time.
  McapWriter(Sink sink, const std::string& library);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Their ids; schemas count from 1, channels from 0. All come before the first message, so that a file that
  /// is cut later has them.
  std::uint16_t add(const McapSchema& schema);
  std::uint16_t add(const McapChannel& channel);

  /// Times are nanoseconds since 1970: of the wall clock, and of the clock that the data go by.
  void message(std::uint16_t channel, std::uint64_t log_ns, std::uint64_t publish_ns, std::string_view data);
  void add(const McapAttachment& attachment);
  void add(const McapMetadata& metadata);

  /// Writes the chunk that is open; what came so far survives the end of the process once the sink has it.
  void endChunk();
  /// Writes the summary and ends the file; nothing may follow.
  void finish();

 private:
  struct Compressor;
  // What the summary says of a record: where it begins and how long it is, in bytes, and what is in it.
  struct ChunkIndex {
    std::uint64_t start_ns, end_ns, offset, length, index_length, compressed, uncompressed;
    std::map<std::uint16_t, std::uint64_t> message_index;  // channel -> where its index stands
    std::string content() const;
  };
  struct AttachmentIndex {
    std::uint64_t offset, length, time_ns, size;
    std::string name, media_type;
    std::string content() const;
  };
  struct MetadataIndex {
    std::uint64_t offset, length;
    std::string name;
    std::string content() const;
  };
  using Times =
      std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // of a message, and its place in the chunk

  void put(std::string_view bytes);
  void putRecord(McapOpcode opcode, std::string_view content);
  void writeMessageIndex(ChunkIndex& chunk);
  void writeSummary();
  std::string statistics() const;

  Sink sink_;
  std::unique_ptr<Compressor> compressor_;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;
  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  std::vector<std::uint64_t> counts_;  ///< messages of each channel
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::vector<MetadataIndex> metadata_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  ///< of all messages

  std::string chunk_;
  std::vector<Times> chunk_times_;  ///< of each channel
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
};

}  // namespace patella::formats
