// Reads MCAP files from the front, without their index: a file that was cut off, as where the program that
// wrote it was killed, gives every record that is whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "firmware_app/formats/mcap_writer.hpp"

namespace patella::formats {

struct McapSchemaRecord {
  std::uint16_t id = 0;
  McapSchema schema;
};

struct McapChannelRecord {
  std::uint16_t id = 0;
  McapChannel channel;
};

struct McapMessage {
  std::uint16_t channel = 0;
  std::uint64_t log_ns = 0;
  std::uint64_t publish_ns = 0;
  std::string_view data;  ///< until the next record is asked for
};

using McapRecord =
    std::variant<McapMessage, McapSchemaRecord, McapChannelRecord, McapAttachment, McapMetadata>;

class McapReader {
 public:
  /// Throws app::FileError where the file cannot be read or is no MCAP file.
  explicit McapReader(const std::filesystem::path& path);
  ~McapReader();

  /// The next record of the data section, those within chunks included; false at its end. Throws
  /// app::FileError with the place in the file for a record that contradicts its checksum or its own length,
  /// for a compression other than zstd or none, and for a chunk of more than 256 MB.
  bool next(McapRecord& record);
  /// Valid when next() has returned false: the file ends in the midst of its data, at the end of the last
  /// whole record that was read.
  bool cut() const noexcept { return cut_; }
  /// Where that is, bytes from the start of the file.
  std::uint64_t readTo() const noexcept { return at_; }

 private:
  struct Decompressor;

  bool nextOfFile(McapOpcode& opcode);
  void openChunk();
  bool nextOfChunk(McapOpcode& opcode, std::string_view& content);
  [[noreturn]] void fail(const std::string& words) const;

  std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;      ///< end of the last whole record
  std::uint64_t record_ = 0;  ///< start of the one that is being read
  std::unique_ptr<Decompressor> decompressor_;
  std::string content_;
  std::string chunk_;
  std::size_t chunk_at_ = 0;
  bool ended_ = false;
  bool cut_ = false;
};

/// True for a file that begins as MCAP files do. False where it cannot be read.
bool isMcap(const std::filesystem::path& path);

}  // namespace patella::formats
