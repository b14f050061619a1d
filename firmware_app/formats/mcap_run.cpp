#include "firmware_app/formats/mcap_run.hpp"

#include <array>
#include <utility>

namespace patella::formats {

McapRun::McapRun(McapWriter::Sink sink, const std::string& library, const std::vector<std::string>& columns,
                 RunInputs inputs)
    : writer_(std::move(sink), library),
      messages_(columns),
      sink_([this](RunChannel channel, const MessageTime& time, std::string_view message) {
        writer_.message(static_cast<std::uint16_t>(channel), time.wall_ns, time.loop_ns, message);
      }),
      inputs_(std::move(inputs)) {
  for (const ChannelDescription& channel : messages_.channels()) {
    const std::uint16_t schema =
        writer_.add(McapSchema{.name = channel.type, .encoding = "ros2msg", .text = channel.definition});
    McapChannel record{.schema = schema, .topic = channel.topic, .encoding = "cdr", .metadata = {}};
    if (!channel.columns.empty()) {
      record.metadata[kColumnsKey] = channel.columns;
    }
    writer_.add(record);
  }
}

void McapRun::begin(std::uint64_t time_ns) {
  if (!inputs_) {
    return;
  }
  for (McapAttachment& file : inputs_->files) {
    file.time_ns = time_ns;
    writer_.add(file);
  }
  writer_.add(inputs_->hashes);
  inputs_.reset();
}

void McapRun::tick(std::span<const double> row, const MessageTime& time) {
  begin(time.wall_ns);
  messages_.tick(row, time, sink_);
}

void McapRun::frame(const can::Frame& frame, std::string_view interface, const MessageTime& time) {
  begin(time.wall_ns);
  messages_.frame(frame, interface, time, sink_);
}

void McapRun::event(std::string_view line, const MessageTime& time) {
  begin(time.wall_ns);
  messages_.event(line, time, sink_);
}

void McapRun::finish(const McapMetadata& summary) {
  begin(0);
  messages_.end(sink_);
  writer_.add(summary);
  writer_.finish();
}

std::string mediaType(std::string_view file_name) {
  constexpr std::array<std::pair<std::string_view, const char*>, 4> kTypes = {{{".toml", "application/toml"},
                                                                               {".json", "application/json"},
                                                                               {".dbc", "text/plain"},
                                                                               {".log", "text/plain"}}};
  for (const auto& [suffix, type] : kTypes) {
    if (file_name.ends_with(suffix)) {
      return type;
    }
  }
  return "application/octet-stream";
}

}  // namespace patella::formats
