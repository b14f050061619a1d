#include "tools/view/recording.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/formats/little_endian.hpp"
#include "tools/convert/run_walk.hpp"
#include "tools/view/subscriptions.hpp"

namespace patella::view {
namespace {

// The page shows no single frames: what it says of the bus is in the timing of each second.
bool onPage(formats::RunChannel channel) {
  return channel == formats::RunChannel::kTick || channel == formats::RunChannel::kEvents ||
         channel == formats::RunChannel::kTiming;
}

[[noreturn]] void failTemporary() {
  throw std::runtime_error("temporary file in " P_tmpdir ": " + std::generic_category().message(errno));
}

}  // namespace

class Recording::Reader : public convert::RunVisitor {
 public:
  explicit Reader(Recording& recording) : recording_(recording) {}

  void begin(const std::vector<std::string>& columns) override {
    time_column_ =
        static_cast<std::size_t>(std::find(columns.begin(), columns.end(), "t_s") - columns.begin());
    messages_.emplace(columns);
    recording_.channels_ = messages_->channels();
  }
  void frame(const can::Frame& frame, std::string_view interface, const formats::MessageTime& time) override {
    messages_->frame(frame, interface, time, sink_);
  }
  void tick(std::span<const double> row, const formats::MessageTime& time) override {
    const double time_s = row[time_column_];
    if (recording_.seconds_.empty()) {
      recording_.start_s_ = time_s;
    }
    recording_.end_s_ = time_s;
    // A second without a tick is an empty one.
    const double elapsed_s = std::max(std::floor(time_s) - std::floor(recording_.start_s_), 0.0);
    if (elapsed_s >= kMostSeconds) {
      throw std::invalid_argument("more than a week between the first and the last tick");
    }
    while (static_cast<double>(recording_.seconds_.size()) <= elapsed_s) {
      recording_.seconds_.push_back({.start = at_});
    }
    messages_->tick(row, time, sink_);
  }
  void event(std::string_view line, const formats::MessageTime& time) override {
    messages_->event(line, time, sink_);
    recording_.events_.push_back({.time_s = recording_.end_s_, .line = std::string(line)});
  }
  void end() { messages_->end(sink_); }

 private:
  static constexpr double kMostSeconds = 7.0 * 86'400.0;

  void keep(formats::RunChannel channel, std::uint64_t wall_ns, std::string_view message) {
    if (!onPage(channel) || recording_.seconds_.empty()) {
      return;
    }
    const std::string data = messageData(static_cast<std::uint32_t>(channel), wall_ns, message);
    std::string record;
    formats::appendText(record, data);
    if (std::fwrite(record.data(), 1, record.size(), recording_.file_.get()) != record.size()) {
      failTemporary();
    }
    at_ += record.size();
    recording_.seconds_.back().size += record.size();
  }

  Recording& recording_;
  std::size_t time_column_ = 0;
  std::uint64_t at_ = 0;
  std::optional<formats::RunMessages> messages_;
  formats::RunMessages::Sink sink_ = [this](formats::RunChannel channel, const formats::MessageTime& time,
                                            std::string_view message) {
    keep(channel, time.wall_ns, message);
  };
};

Recording::Recording(const std::filesystem::path& run, const std::function<void(double)>& progress)
    : file_(std::tmpfile()) {
  if (!file_) {
    failTemporary();
  }
  Reader reader(*this);
  convert::walkRun(run, reader, progress);
  if (seconds_.empty()) {
    throw app::FileError((run / "ticks.csv").string() + ": has no tick, expected a recorded run");
  }
  reader.end();
  if (std::fflush(file_.get()) != 0) {
    failTemporary();
  }
}

std::string Recording::index() const {
  nlohmann::json events = nlohmann::json::array();
  for (const Event& event : events_) {
    events.push_back({{"t_s", event.time_s}, {"line", event.line}});
  }
  return nlohmann::json{
      {"start_s", start_s_}, {"end_s", end_s_}, {"seconds", seconds_.size()}, {"events", events}}
      .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

std::string Recording::messagesOf(std::size_t second) const {
  const Span& span = seconds_.at(second);
  std::string bytes(static_cast<std::size_t>(span.size), '\0');
  std::size_t read = 0;
  while (read < bytes.size()) {
    const ssize_t now = pread(fileno(file_.get()), bytes.data() + read, bytes.size() - read,
                              static_cast<off_t>(span.start + read));
    if (now <= 0) {
      failTemporary();
    }
    read += static_cast<std::size_t>(now);
  }
  return bytes;
}

}  // namespace patella::view
