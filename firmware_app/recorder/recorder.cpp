#include "firmware_app/recorder/recorder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <spdlog/spdlog.h>

#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"
#include "core/safety/warning.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/signal_stack.hpp"
#include "firmware_app/live/live_run.hpp"
#include "firmware_app/recorder/recording_folder.hpp"

namespace patella::app {
namespace {

constexpr auto kWriterPeriod = std::chrono::milliseconds(10);
constexpr auto kDiskPeriod = std::chrono::seconds(1);

}  // namespace

class Recorder::Files {
 public:
  /// Adds what it creates to `created`, one by one: a file that another run put there meanwhile is not ours.
  Files(const RecorderOptions& options, std::vector<std::filesystem::path>& created)
      : buses_(options.buses),
        columns_(tickColumns(options.joints)),
        frames_(options.folder, kRecordingFiles[0], created),
        ticks_(options.folder, kRecordingFiles[1], created),
        events_(options.folder, kRecordingFiles[2], created) {
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

  void write(const can::Frame& frame) {
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

  void write(const TickRecord& record) {
    line_.clear();
    row_.clear();
    for (const TickColumn& column : columns_) {
      if (!line_.empty() || &column != columns_.data()) {
        line_ += ',';
      }
      row_.push_back(column.value(record, column.index));
      append(row_.back());
    }
    line_ += '\n';
    ticks_.write(line_.data(), line_.size());
    const formats::MessageTime time = timeOf(record);
    intoMcap([&] { mcap_->tick(row_, time); });
    if (live_) {
      live_->tick(row_, time);
    }
    writeEvents(record, time);
  }

  void flush() {
    frames_.flush();
    ticks_.flush();
    events_.flush();
    if (mcap_file_) {
      mcap_file_->flush();
    }
  }

  void finish(const formats::McapMetadata& summary) {
    intoMcap([&] { mcap_->finish(summary); });
    flush();
  }

  std::string error() const {
    for (const OutputFile* file : {&frames_, &ticks_, &events_}) {
      if (!file->error().empty()) {
        return file->error();
      }
    }
    return mcap_file_ && !mcap_file_->error().empty() ? mcap_file_->error() : mcap_error_;
  }

 private:
  static constexpr std::size_t kLineCapacity = 2048;

  static std::vector<std::string> namesOf(const std::vector<TickColumn>& columns) {
    std::vector<std::string> names;
    for (const TickColumn& column : columns) {
      names.push_back(column.name);
    }
    return names;
  }

  // Nothing more enters run.mcap once something could not; the other files go on.
  template <typename Write>
  void intoMcap(Write&& write) {
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
  formats::MessageTime timeOf(const TickRecord& record) {
    const std::int64_t since_start_ns = std::llround(1e9 * record.time_s);
    if (!loop_epoch_ns_) {
      loop_epoch_ns_ = record.wall_ns - since_start_ns;
    }
    return {.wall_ns = static_cast<std::uint64_t>(record.wall_ns),
            .loop_ns = static_cast<std::uint64_t>(*loop_epoch_ns_ + since_start_ns)};
  }

  // Shortest text that reads back as the same double; nothing for NaN.
  void append(double value) {
    if (std::isnan(value)) {
      return;
    }
    std::array<char, 32> text{};
    const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
    line_.append(text.data(), result.ptr);
  }

  // A line for every change of state and for every cause that appears or goes.
  void writeEvents(const TickRecord& record, const formats::MessageTime& time) {
    const bool noticed = std::any_of(
        record.notices.begin(), record.notices.end(),
        [](const canopen::NodeNotice& notice) { return notice.kind != canopen::NoticeKind::kNone; });
    if (record.state == last_state_ && record.faults == last_faults_ && record.missed_periods == 0 &&
        record.warnings == last_warnings_ && !noticed) {
      return;
    }
    line_ = "t_s=";
    append(record.time_s);
    line_ += " state=";
    line_ += safety::stateName(static_cast<safety::State>(record.state));
    bool raised = false;
    for (int i = 0; i < safety::kFaultCount; ++i) {
      const auto fault = static_cast<safety::Fault>(i);
      const bool is = safety::FaultSet(record.faults).has(fault);
      const bool was = safety::FaultSet(last_faults_).has(fault);
      raised = raised || (is && !was);
      if (is != was) {
        line_ += std::string(is ? " raised=" : " cleared=") + std::string(safety::faultName(fault));
      }
    }
    for (std::size_t bus = 0; raised && bus < buses_.size(); ++bus) {
      if ((record.fault_buses & can::busBit(bus)) != 0 && !buses_[bus].name.empty()) {
        line_ += " bus=" + buses_[bus].name;
      }
    }
    for (int i = 0; i < safety::kWarningCount; ++i) {
      const auto warning = static_cast<safety::Warning>(i);
      const bool is = safety::WarningSet(record.warnings).has(warning);
      if (is != safety::WarningSet(last_warnings_).has(warning)) {
        line_ += std::string(is ? " warning=" : " no_longer=") + std::string(safety::warningName(warning));
      }
    }
    if (record.missed_periods != 0) {
      line_ += " missed_periods=" + std::to_string(record.missed_periods);
    }
    for (const canopen::NodeNotice& notice : record.notices) {
      if (notice.kind != canopen::NoticeKind::kNone) {
        line_ += " " + canopen::noticeText(notice);
      }
    }
    intoMcap([&] { mcap_->event(line_, time); });
    if (live_) {
      live_->event(line_, time);
    }
    line_ += '\n';
    events_.write(line_.data(), line_.size());
    last_state_ = record.state;
    last_faults_ = record.faults;
    last_warnings_ = record.warnings;
  }

  std::vector<RecordedBus> buses_;
  std::vector<TickColumn> columns_;
  OutputFile frames_;
  OutputFile ticks_;
  OutputFile events_;
  std::unique_ptr<OutputFile> mcap_file_;
  std::unique_ptr<formats::McapRun> mcap_;
  std::string mcap_error_;
  std::unique_ptr<live::LiveRun> live_;
  std::optional<std::int64_t> loop_epoch_ns_;
  std::string line_;
  std::vector<double> row_;
  std::array<char, can::kMaxLogLine> buffer_{};
  std::uint8_t last_state_ = 255;
  std::uint32_t last_faults_ = 0;
  std::uint32_t last_warnings_ = 0;
};

Recorder::Recorder(const RecorderOptions& options) : options_(options) {
  requireNoRecording(options.folder);
  requireRoom(options);
  try {
    created_ = missingFolders(options.folder);
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error) {
      throw std::runtime_error(options.folder.string() + ": cannot be created: " + error.message());
    }
    files_ = std::make_shared<Files>(options, created_);
    thread_ = startThread([this, files = files_] { write(*files); });
  } catch (...) {
    discard();
    throw;
  }
}

Recorder::~Recorder() {
  close();
}

void Recorder::close() noexcept {
  stop_.store(true, std::memory_order_release);
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Recorder::finish(const formats::McapMetadata& summary) noexcept {
  files_->finish(summary);
  error_ = files_->error();
}

void Recorder::discard() noexcept {
  close();
  std::error_code ignored;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) {
    std::filesystem::remove(*path, ignored);
  }
}

bool Recorder::behind() noexcept PATELLA_NONBLOCKING {
  const auto crowded = [](const auto& ring) { return 4 * ring.size() > 3 * ring.capacity(); };
  const std::uint64_t dropped = dropped_ticks_ + dropped_frames_;
  const bool lost = dropped != dropped_before_;
  dropped_before_ = dropped;
  // A lossless recorder makes the loop wait: its rings may be full.
  return lost || (!options_.lossless && (crowded(ticks_) || crowded(frames_)));
}

void Recorder::tick(const TickRecord& record) noexcept PATELLA_NONBLOCKING {
  const auto write = [&](Entry& entry) noexcept {
    copyRecord(record, entry.record);
    entry.frames = accepted_frames_;
  };
  while (!ticks_.pushBy(write)) {
    if (!options_.lossless) {
      ++dropped_ticks_;
      return;
    }
  }
}

void Recorder::frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  while (!frames_.push(frame)) {
    if (!options_.lossless) {
      ++dropped_frames_;
      return;
    }
  }
  ++accepted_frames_;
}

// Writes the frames up to the one of that number, and says whether there were any.
bool Recorder::writeFrames(Files& files, std::uint64_t count) {
  can::Frame frame;
  bool worked = false;
  while (writtenFrames() < count && frames_.pop(frame)) {
    files.write(frame);
    written_frames_.fetch_add(1, std::memory_order_release);
    worked = true;
  }
  return worked;
}

void Recorder::write(Files& files) {
  constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();
  Entry entry;
  auto next_look = std::chrono::steady_clock::now();
  while (true) {
    if (const auto now = std::chrono::steady_clock::now(); options_.min_free_bytes > 0 && now >= next_look) {
      next_look = now + kDiskPeriod;
      disk_low_.store(freeBytes(options_.folder) < options_.min_free_bytes, std::memory_order_relaxed);
    }
    const bool last_round = stop_.load(std::memory_order_acquire);
    bool worked = false;
    while (ticks_.pop(entry)) {
      // The frames of a tick stand before it, so that a run in virtual time gives the same file again.
      writeFrames(files, entry.frames);
      files.write(entry.record);
      written_ticks_.fetch_add(1, std::memory_order_release);
      worked = true;
    }
    if (last_round || !options_.lossless) {
      worked = writeFrames(files, kAll) || worked;
    }
    if (!failed_.load(std::memory_order_relaxed) && !files.error().empty()) {
      failed_.store(true, std::memory_order_relaxed);
      spdlog::error("recording failed: {}", files.error());  // events.log may be what failed
    }
    if (last_round) {
      break;
    }
    if (!worked || !options_.lossless) {
      files.flush();
      std::this_thread::sleep_for(options_.lossless ? std::chrono::milliseconds(1) : kWriterPeriod);
    }
  }
  files.flush();
  error_ = files.error();
}

}  // namespace patella::app
