#include "firmware_app/recorder/recording_files.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string_view>

#include <spdlog/spdlog.h>

#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr std::size_t kLineCapacity = 2048;

std::vector<std::string> namesOf(const std::vector<TickColumn>& columns) {
  std::vector<std::string> names;
  for (const TickColumn& column : columns) {
    names.push_back(column.name);
  }
  return names;
}

}  // namespace

RecordingFiles::RecordingFiles(const RecorderOptions& options, std::vector<std::filesystem::path>& created)
    : buses_(options.buses),
      columns_(tickColumns(options.joints)),
      frames_(options.folder, kRecordingFiles[0], created),
      ticks_(options.folder, kRecordingFiles[1], created),
      events_(options.folder, kRecordingFiles[2], created),
      event_lines_(options.buses) {
  if (options.mcap) {
    mcap_file_ = std::make_unique<OutputFile>(options.folder, kRecordingFiles[3], created);
    mcap_ = std::make_unique<formats::McapRun>(
        [this](std::string_view bytes) { mcap_file_->write(bytes.data(), bytes.size()); },
        "patella " PATELLA_VERSION, namesOf(columns_), *options.mcap);
  }
  if (options.live) {
    try {
      live_ = std::make_unique<live::LiveRun>(options.folder, namesOf(columns_));
    } catch (const std::runtime_error& error) {
      spdlog::warn("nobody can watch this run: {}", error.what());
    }
  }
  line_.reserve(kLineCapacity);
  for (const TickColumn& column : columns_) {
    line_ += line_.empty() ? "" : ",";
    line_ += column.name;
  }
  line_ += '\n';
  ticks_.write(line_.data(), line_.size());
  events_.write(options.heading.data(), options.heading.size());
}

void RecordingFiles::write(const can::Frame& frame) {
  const std::string& interface = buses_[std::min<std::size_t>(frame.bus, buses_.size() - 1)].interface;
  const std::size_t length = can::formatLogLine(buffer_, frame, interface);
  frames_.write(buffer_.data(), length);
  const auto wall_ns = static_cast<std::uint64_t>(frame.wall_ns);
  const formats::MessageTime time{.wall_ns = wall_ns, .loop_ns = wall_ns};
  intoMcap([&] { mcap_->frame(frame, interface, time); });
  if (live_) {
    live_->frame(frame, interface, time);
  }
}

void RecordingFiles::write(const TickRecord& record) {
  line_.clear();
  row_.clear();
  for (const TickColumn& column : columns_) {
    if (!line_.empty() || &column != columns_.data()) {
      line_ += ',';
    }
    row_.push_back(column.value(record, column.index));
    if (!std::isnan(row_.back())) {
      appendFormatted(line_, row_.back());
    }
  }
  line_ += '\n';
  ticks_.write(line_.data(), line_.size());
  const formats::MessageTime time = timeOf(record);
  intoMcap([&] { mcap_->tick(row_, time); });
  if (live_) {
    live_->tick(row_, time);
  }
  if (!event_lines_.next(record, line_)) {
    return;
  }
  intoMcap([&] { mcap_->event(line_, time); });
  if (live_) {
    live_->event(line_, time);
  }
  line_ += '\n';
  events_.write(line_.data(), line_.size());
}

void RecordingFiles::flush() {
  frames_.flush();
  ticks_.flush();
  events_.flush();
  if (mcap_file_) {
    mcap_file_->flush();
  }
}

void RecordingFiles::finish(const formats::McapMetadata& summary) {
  intoMcap([&] { mcap_->finish(summary); });
  flush();
}

std::string RecordingFiles::error() const {
  for (const OutputFile* file : {&frames_, &ticks_, &events_}) {
    if (!file->error().empty()) {
      return file->error();
    }
  }
  return mcap_file_ && !mcap_file_->error().empty() ? mcap_file_->error() : mcap_error_;
}

// Nothing more enters run.mcap once something could not; the other files go on.
template <typename Write>
void RecordingFiles::intoMcap(Write&& write) {
  if (!mcap_ || !mcap_error_.empty()) {
    return;
  }
  try {
    write();
  } catch (const std::exception& error) {
    mcap_error_ = std::string(kRecordingFiles[3]) + ": " + error.what();
  }
}

// The loop's clock is set to the wall's at the first tick.
formats::MessageTime RecordingFiles::timeOf(const TickRecord& record) {
  const std::int64_t since_start_ns = std::llround(1e9 * record.time_s);
  if (!loop_epoch_ns_) {
    loop_epoch_ns_ = record.wall_ns - since_start_ns;
  }
  return {.wall_ns = static_cast<std::uint64_t>(record.wall_ns),
          .loop_ns = static_cast<std::uint64_t>(*loop_epoch_ns_ + since_start_ns)};
}

}  // namespace patella::app
