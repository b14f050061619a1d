#include "firmware_app/formats/mcap_writer.hpp"

#include <algorithm>
#include <stdexcept>

#include <zstd.h>

#include "firmware_app/formats/little_endian.hpp"
#include "firmware_app/formats/mcap_crc.hpp"

namespace patella::formats {
namespace {

constexpr std::size_t kChunkBytes = 1U << 20;
constexpr std::uint64_t kChunkTime_ns = 1'000'000'000;
constexpr int kCompressionLevel = 3;

std::string contentOf(const McapSchema& schema, std::uint16_t id) {
  std::string content;
  appendNumber(content, id);
  appendText(content, schema.name);
  appendText(content, schema.encoding);
  appendText(content, schema.text);
  return content;
}

std::string contentOf(const McapChannel& channel, std::uint16_t id) {
  std::string content;
  appendNumber(content, id);
  appendNumber(content, channel.schema);
  appendText(content, channel.topic);
  appendText(content, channel.encoding);
  appendMap(content, channel.metadata);
  return content;
}

std::string head(McapOpcode opcode, std::uint64_t length) {
  std::string out;
  appendNumber(out, static_cast<std::uint8_t>(opcode));
  appendNumber(out, length);
  return out;
}

}  // namespace

struct McapWriter::Compressor {
  Compressor() : context(ZSTD_createCCtx()) {
    if (context == nullptr) {
      throw std::bad_alloc();
    }
  }
  ~Compressor() { ZSTD_freeCCtx(context); }
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  std::string_view operator()(std::string_view bytes) {
    buffer.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size = ZSTD_compressCCtx(context, buffer.data(), buffer.size(), bytes.data(),
                                               bytes.size(), kCompressionLevel);
    if (ZSTD_isError(size) != 0) {
      throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
    }
    return {buffer.data(), size};
  }

  ZSTD_CCtx* context;
  std::string buffer;
};

McapWriter::McapWriter(Sink sink, const std::string& library)
    : sink_(std::move(sink)), compressor_(std::make_unique<Compressor>()) {
  put(kMcapMagic);
  std::string content;
  appendText(content, "ros2");
  appendText(content, library);
  putRecord(McapOpcode::kHeader, content);
}

McapWriter::~McapWriter() = default;

void McapWriter::put(std::string_view bytes) {
  crc_ = mcapCrc(bytes, crc_);
  written_ += bytes.size();
  sink_(bytes);
}

void McapWriter::putRecord(McapOpcode opcode, std::string_view content) {
  put(head(opcode, content.size()));
  put(content);
}

std::uint16_t McapWriter::add(const McapSchema& schema) {
  schemas_.push_back(schema);
  const auto id = static_cast<std::uint16_t>(schemas_.size());
  putRecord(McapOpcode::kSchema, contentOf(schema, id));
  return id;
}

std::uint16_t McapWriter::add(const McapChannel& channel) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back(channel);
  counts_.push_back(0);
  chunk_times_.emplace_back();
  putRecord(McapOpcode::kChannel, contentOf(channel, id));
  return id;
}

void McapWriter::message(std::uint16_t channel, std::uint64_t log_ns, std::uint64_t publish_ns,
                         std::string_view data) {
  const bool whole_second = !chunk_.empty() && log_ns > chunk_first_ns_ + kChunkTime_ns;
  if (chunk_.size() >= kChunkBytes || whole_second) {
    endChunk();
  }
  const bool first =
      std::all_of(counts_.begin(), counts_.end(), [](std::uint64_t count) { return count == 0; });
  first_ns_ = first ? log_ns : std::min(first_ns_, log_ns);
  last_ns_ = first ? log_ns : std::max(last_ns_, log_ns);
  chunk_first_ns_ = chunk_.empty() ? log_ns : std::min(chunk_first_ns_, log_ns);
  chunk_last_ns_ = chunk_.empty() ? log_ns : std::max(chunk_last_ns_, log_ns);
  chunk_times_[channel].emplace_back(log_ns, chunk_.size());
  constexpr std::uint64_t kFields = 2 + 4 + 8 + 8;
  appendNumber(chunk_, static_cast<std::uint8_t>(McapOpcode::kMessage));
  appendNumber(chunk_, kFields + data.size());
  appendNumber(chunk_, channel);
  appendNumber(chunk_, static_cast<std::uint32_t>(counts_[channel]));
  appendNumber(chunk_, log_ns);
  appendNumber(chunk_, publish_ns);
  chunk_.append(data);
  ++counts_[channel];
}

void McapWriter::endChunk() {
  if (chunk_.empty()) {
    return;
  }
  const std::string_view compressed = (*compressor_)(chunk_);
  std::string content;
  appendNumber(content, chunk_first_ns_);
  appendNumber(content, chunk_last_ns_);
  appendNumber(content, static_cast<std::uint64_t>(chunk_.size()));
  appendNumber(content, mcapCrc(chunk_));
  appendText(content, "zstd");
  appendNumber(content, static_cast<std::uint64_t>(compressed.size()));
  content.append(compressed);
  ChunkIndex index{.start_ns = chunk_first_ns_,
                   .end_ns = chunk_last_ns_,
                   .offset = written_,
                   .length = kMcapRecordHead + content.size(),
                   .index_length = 0,
                   .compressed = compressed.size(),
                   .uncompressed = chunk_.size(),
                   .message_index = {}};
  putRecord(McapOpcode::kChunk, content);
  writeMessageIndex(index);
  chunks_.push_back(std::move(index));
  chunk_.clear();
}

void McapWriter::writeMessageIndex(ChunkIndex& chunk) {
  const std::uint64_t start = written_;
  for (std::size_t channel = 0; channel < chunk_times_.size(); ++channel) {
    Times& times = chunk_times_[channel];
    if (times.empty()) {
      continue;
    }
    const auto id = static_cast<std::uint16_t>(channel);
    chunk.message_index[id] = written_;
    // Those of one time by their place, which is the order in which they came.
    std::sort(times.begin(), times.end());
    std::string content;
    appendNumber(content, id);
    appendNumber(content, static_cast<std::uint32_t>(times.size() * 2 * sizeof(std::uint64_t)));
    for (const auto& [time_ns, place] : times) {
      appendNumber(content, time_ns);
      appendNumber(content, place);
    }
    putRecord(McapOpcode::kMessageIndex, content);
    times.clear();
  }
  chunk.index_length = written_ - start;
}

void McapWriter::add(const McapAttachment& attachment) {
  endChunk();
  std::string content;
  appendNumber(content, attachment.time_ns);
  appendNumber(content, attachment.time_ns);
  appendText(content, attachment.name);
  appendText(content, attachment.media_type);
  appendNumber(content, static_cast<std::uint64_t>(attachment.data.size()));
  content.append(attachment.data);
  appendNumber(content, mcapCrc(content));
  attachments_.push_back({.offset = written_,
                          .length = kMcapRecordHead + content.size(),
                          .time_ns = attachment.time_ns,
                          .size = attachment.data.size(),
                          .name = attachment.name,
                          .media_type = attachment.media_type});
  putRecord(McapOpcode::kAttachment, content);
}

void McapWriter::add(const McapMetadata& metadata) {
  endChunk();
  std::string content;
  appendText(content, metadata.name);
  appendMap(content, metadata.values);
  metadata_.push_back(
      {.offset = written_, .length = kMcapRecordHead + content.size(), .name = metadata.name});
  putRecord(McapOpcode::kMetadata, content);
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  std::string counts;
  for (std::size_t channel = 0; channel < counts_.size(); ++channel) {
    messages += counts_[channel];
    if (counts_[channel] > 0) {
      appendNumber(counts, static_cast<std::uint16_t>(channel));
      appendNumber(counts, counts_[channel]);
    }
  }
  std::string content;
  appendNumber(content, messages);
  appendNumber(content, static_cast<std::uint16_t>(schemas_.size()));
  appendNumber(content, static_cast<std::uint32_t>(channels_.size()));
  appendNumber(content, static_cast<std::uint32_t>(attachments_.size()));
  appendNumber(content, static_cast<std::uint32_t>(metadata_.size()));
  appendNumber(content, static_cast<std::uint32_t>(chunks_.size()));
  appendNumber(content, first_ns_);
  appendNumber(content, last_ns_);
  appendText(content, counts);
  return content;
}

std::string McapWriter::ChunkIndex::content() const {
  std::string places;
  for (const auto& [channel, place] : message_index) {
    appendNumber(places, channel);
    appendNumber(places, place);
  }
  std::string content;
  for (const std::uint64_t number : {start_ns, end_ns, offset, length}) {
    appendNumber(content, number);
  }
  appendText(content, places);
  appendNumber(content, index_length);
  appendText(content, "zstd");
  appendNumber(content, compressed);
  appendNumber(content, uncompressed);
  return content;
}

std::string McapWriter::AttachmentIndex::content() const {
  std::string content;
  for (const std::uint64_t number : {offset, length, time_ns, time_ns, size}) {
    appendNumber(content, number);
  }
  appendText(content, name);
  appendText(content, media_type);
  return content;
}

std::string McapWriter::MetadataIndex::content() const {
  std::string content;
  appendNumber(content, offset);
  appendNumber(content, length);
  appendText(content, name);
  return content;
}

// Groups of records of one kind, and where each group stands.
void McapWriter::writeSummary() {
  const std::uint64_t start = written_;
  crc_ = 0;
  std::string offsets;
  const auto group = [&](McapOpcode opcode, const auto& items, auto&& contentOfItem) {
    const std::uint64_t group_start = written_;
    for (std::size_t i = 0; i < items.size(); ++i) {
      putRecord(opcode, contentOfItem(items[i], i));
    }
    if (!items.empty()) {
      std::string content;
      appendNumber(content, static_cast<std::uint8_t>(opcode));
      appendNumber(content, group_start);
      appendNumber(content, written_ - group_start);
      offsets += head(McapOpcode::kSummaryOffset, content.size()) + content;
    }
  };
  group(McapOpcode::kSchema, schemas_, [](const McapSchema& schema, std::size_t i) {
    return contentOf(schema, static_cast<std::uint16_t>(i + 1));
  });
  group(McapOpcode::kChannel, channels_, [](const McapChannel& channel, std::size_t i) {
    return contentOf(channel, static_cast<std::uint16_t>(i));
  });
  group(McapOpcode::kStatistics, std::vector{statistics()},
        [](const std::string& content, std::size_t /*i*/) { return content; });
  const auto content_of_index = [](const auto& index, std::size_t /*i*/) { return index.content(); };
  group(McapOpcode::kChunkIndex, chunks_, content_of_index);
  group(McapOpcode::kAttachmentIndex, attachments_, content_of_index);
  group(McapOpcode::kMetadataIndex, metadata_, content_of_index);
  const std::uint64_t offsets_start = written_;
  put(offsets);
  // The checksum of the summary reaches to the field before its own.
  std::string footer = head(McapOpcode::kFooter, 8 + 8 + 4);
  appendNumber(footer, start);
  appendNumber(footer, offsets_start);
  put(footer);
  std::string end;
  appendNumber(end, crc_);
  put(end);
}

void McapWriter::finish() {
  endChunk();
  std::string content;
  appendNumber(content, crc_);
  putRecord(McapOpcode::kDataEnd, content);
  writeSummary();
  put(kMcapMagic);
}

}  // namespace patella::formats
