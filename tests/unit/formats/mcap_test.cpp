// MCAP files that are whole, cut off at any byte, spoilt in any byte, and made to hurt.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/formats/little_endian.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using formats::McapOpcode;

namespace {

struct Message {
  std::uint16_t channel;
  std::uint64_t log_ns, publish_ns;
  std::string data;
  bool operator==(const Message&) const = default;
};

struct Contents {
  std::vector<std::string> schemas, topics, attachments, metadata;
  std::vector<Message> messages;
  bool cut = false;
  std::uint64_t read_to = 0;
};

constexpr int kChunks = 4;
constexpr int kPerChunk = 5;

std::vector<Message> someMessages() {
  std::vector<Message> messages;
  for (int i = 0; i < kChunks * kPerChunk; ++i) {
    const auto number = static_cast<std::uint64_t>(i);
    messages.push_back({static_cast<std::uint16_t>(i % 2), 1'000'000 * number, 2'000'000 * number,
                        std::string(static_cast<std::size_t>(i), static_cast<char>('a' + i))});
  }
  return messages;
}

std::string smallFile() {
  std::string file;
  formats::McapWriter writer([&](std::string_view bytes) { file += bytes; }, "test");
  const std::uint16_t schema = writer.add(formats::McapSchema{"a/msg/A", "ros2msg", "uint8 a\n"});
  writer.add(formats::McapChannel{schema, "/even", "cdr", {{"key", "value"}}});
  writer.add(formats::McapChannel{schema, "/odd", "cdr", {}});
  writer.add(formats::McapAttachment{7, "model.toml", "application/toml", "mass = 1\n"});
  writer.add(formats::McapMetadata{"inputs", {{"model", "its hash"}}});
  int in_chunk = 0;
  for (const Message& message : someMessages()) {
    writer.message(message.channel, message.log_ns, message.publish_ns, message.data);
    if (++in_chunk == kPerChunk) {
      writer.endChunk();
      in_chunk = 0;
    }
  }
  writer.add(formats::McapMetadata{"summary", {}});
  writer.finish();
  return file;
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

Contents read(const std::filesystem::path& path) {
  formats::McapReader reader(path);
  Contents contents;
  formats::McapRecord record;
  while (reader.next(record)) {
    if (const auto* message = std::get_if<formats::McapMessage>(&record)) {
      contents.messages.push_back(
          {message->channel, message->log_ns, message->publish_ns, std::string(message->data)});
    } else if (const auto* schema = std::get_if<formats::McapSchemaRecord>(&record)) {
      contents.schemas.push_back(schema->schema.name);
    } else if (const auto* channel = std::get_if<formats::McapChannelRecord>(&record)) {
      contents.topics.push_back(channel->channel.topic);
    } else if (const auto* attachment = std::get_if<formats::McapAttachment>(&record)) {
      contents.attachments.push_back(attachment->name + ": " + attachment->data);
    } else if (const auto* metadata = std::get_if<formats::McapMetadata>(&record)) {
      contents.metadata.push_back(metadata->name);
    }
  }
  contents.cut = reader.cut();
  contents.read_to = reader.readTo();
  return contents;
}

/// Where each record of a whole file ends, by its own length.
std::vector<std::pair<McapOpcode, std::size_t>> endsOf(const std::string& file) {
  std::vector<std::pair<McapOpcode, std::size_t>> ends;
  std::size_t at = formats::kMcapMagic.size();
  while (at + formats::kMcapMagic.size() < file.size()) {
    std::uint64_t length = 0;
    std::memcpy(&length, file.data() + at + 1, sizeof(length));
    const auto opcode = static_cast<McapOpcode>(file[at]);
    at += formats::kMcapRecordHead + length;
    ends.emplace_back(opcode, at);
  }
  return ends;
}

std::string record(McapOpcode opcode, const std::string& content) {
  std::string bytes;
  formats::appendNumber(bytes, static_cast<std::uint8_t>(opcode));
  formats::appendNumber(bytes, static_cast<std::uint64_t>(content.size()));
  return bytes + content;
}

std::string chunk(std::uint64_t size, const std::string& compression, const std::string& records) {
  std::string content;
  formats::appendNumber(content, std::uint64_t{0});
  formats::appendNumber(content, std::uint64_t{0});
  formats::appendNumber(content, size);
  formats::appendNumber(content, std::uint32_t{0});  // no checksum
  formats::appendText(content, compression);
  formats::appendNumber(content, static_cast<std::uint64_t>(records.size()));
  return record(McapOpcode::kChunk, content + records);
}

}  // namespace

TEST_CASE("what is written to an MCAP file is read from it, and twice the same gives the same bytes") {
  const test::ScratchFolder folder;
  write(folder / "a.mcap", smallFile());
  CHECK(smallFile() == smallFile());
  const Contents contents = read(folder / "a.mcap");
  CHECK(contents.schemas == std::vector<std::string>{"a/msg/A"});
  CHECK(contents.topics == std::vector<std::string>{"/even", "/odd"});
  CHECK(contents.attachments == std::vector<std::string>{"model.toml: mass = 1\n"});
  CHECK(contents.metadata == std::vector<std::string>{"inputs", "summary"});
  CHECK(contents.messages == someMessages());
  CHECK_FALSE(contents.cut);
}

TEST_CASE("of an MCAP file that is cut at any byte, every whole record is read") {
  const test::ScratchFolder folder;
  const std::string whole = smallFile();
  const auto ends = endsOf(whole);
  const std::vector<Message> all = someMessages();
  const std::filesystem::path path = folder / "cut.mcap";
  write(path, whole);
  CHECK(ends.back().second + formats::kMcapMagic.size() == whole.size());
  for (std::size_t length = whole.size(); length-- > 0;) {
    CAPTURE(length);
    std::filesystem::resize_file(path, length);
    if (length < formats::kMcapMagic.size()) {
      CHECK_THROWS_AS(read(path), app::FileError);
      continue;
    }
    std::size_t messages = 0;
    std::size_t attachments = 0;
    std::size_t metadata = 0;
    bool data_ended = false;
    std::size_t last_end = formats::kMcapMagic.size();
    for (const auto& [opcode, end] : ends) {
      if (end > length || data_ended) {
        break;
      }
      messages += opcode == McapOpcode::kChunk ? kPerChunk : 0;
      attachments += opcode == McapOpcode::kAttachment ? 1 : 0;
      metadata += opcode == McapOpcode::kMetadata ? 1 : 0;
      data_ended = opcode == McapOpcode::kDataEnd;
      last_end = end;
    }
    const Contents contents = read(path);
    CHECK(contents.messages == std::vector<Message>(all.begin(), all.begin() + static_cast<long>(messages)));
    CHECK(contents.attachments.size() == attachments);
    CHECK(contents.metadata.size() == metadata);
    CHECK(contents.cut == !data_ended);
    CHECK(contents.read_to == last_end);
  }
}

TEST_CASE("an MCAP file with one spoilt byte is refused, or gives no message that was not written") {
  const test::ScratchFolder folder;
  const std::string whole = smallFile();
  const std::vector<Message> all = someMessages();
  const std::filesystem::path path = folder / "spoilt.mcap";
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    CAPTURE(i);
    std::string spoilt = whole;
    spoilt[i] = static_cast<char>(spoilt[i] ^ 0x55);
    write(path, spoilt);
    try {
      for (const Message& message : read(path).messages) {
        CHECK(std::find(all.begin(), all.end(), message) != all.end());
      }
    } catch (const app::FileError&) {
      ++refused;
    }
  }
  CHECK(refused > kChunks);
}

TEST_CASE("MCAP files that are made to hurt are refused in words") {
  const test::ScratchFolder folder;
  const std::filesystem::path path = folder / "bad.mcap";
  const auto refusal = [&](const std::string& records) {
    write(path, std::string(formats::kMcapMagic) + records);
    return test::messageOf<app::FileError>([&] { read(path); });
  };
  const auto says = [](const std::string& message, const char* words) {
    CAPTURE(message);
    CHECK(message.find(words) != std::string::npos);
  };
  says(refusal(chunk(1'000'000'000'000, "zstd", "x")), "record at byte 8: a chunk of 1000000000000 bytes");
  says(refusal(chunk(1, "lz4", "x")), "compression 'lz4', expected zstd or none");
  says(refusal(chunk(10, "zstd", "no zstd")), "cannot be decompressed");
  says(refusal(chunk(5, "", "x")), "contradicts its length");
  const std::string inner = chunk(0, "", "");
  says(refusal(chunk(inner.size(), "", inner)), "a chunk within a chunk");
  says(refusal(record(McapOpcode::kMessage, "abc")), "ends before its last field");
  const std::string too_long = std::string("\x05\xff\xff\xff\xff\xff\xff\xff\xff", 9);
  says(refusal(chunk(too_long.size(), "", too_long)), "ends before its last field");
  write(path, "t_s,q1_rad\n");
  says(test::messageOf<app::FileError>([&] { read(path); }), "does not begin as an MCAP file does");
  says(test::messageOf<app::FileError>([&] { read(folder.path()); }), "is no file that can be read");
}
