#include "tools/convert/run_walk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "drivers/can/candump_log.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tools/convert/run_events.hpp"
#include "tools/convert/run_rows.hpp"

namespace patella::convert {
namespace {

constexpr double kSecond_ns = 1e9;

/// The frames of a run, the next one in sight.
class FrameStream {
 public:
  explicit FrameStream(const std::filesystem::path& file) {
    if (std::filesystem::exists(file)) {
      reader_.emplace(file);
      advance();
    }
  }
  const can::LogEntry* next() const noexcept { return more_ ? &entry_ : nullptr; }
  void advance() { more_ = reader_->next(entry_); }

 private:
  std::optional<can::CandumpReader> reader_;
  can::LogEntry entry_;
  bool more_ = false;
};

}  // namespace

void walkRun(const std::filesystem::path& run, RunVisitor& visitor,
             const std::function<void(double)>& progress) {
  if (!std::filesystem::is_directory(run)) {
    throw app::FileError(run.string() + ": is no folder, expected that of a run");
  }
  const std::filesystem::path ticks = run / "ticks.csv";
  RunRows rows(ticks);
  const auto time_column = static_cast<std::size_t>(
      std::find(rows.columns().begin(), rows.columns().end(), "t_s") - rows.columns().begin());
  FrameStream frames(run / "frames.log");
  RunEvents events(run / "events.log");
  const std::int64_t epoch_ns = frames.next() == nullptr ? 0 : frames.next()->frame.wall_ns;
  const auto at = [&](double time_s) {
    const auto wall_ns = static_cast<std::uint64_t>(epoch_ns + std::llround(time_s * kSecond_ns));
    return formats::MessageTime{.wall_ns = wall_ns, .loop_ns = wall_ns};
  };
  const auto pass_frame = [&] {
    const can::LogEntry& entry = *frames.next();
    const auto wall_ns = static_cast<std::uint64_t>(entry.frame.wall_ns);
    visitor.frame(entry.frame, entry.interface, {.wall_ns = wall_ns, .loop_ns = wall_ns});
    frames.advance();
  };
  const auto pass_event = [&] {
    visitor.event(events.line(), at(events.time_s()));
    events.advance();
  };
  const auto size = static_cast<double>(std::filesystem::file_size(ticks));
  try {
    visitor.begin(rows.columns());
    std::vector<double> row;
    while (rows.next(row)) {
      const double time_s = row[time_column];
      const formats::MessageTime time = at(time_s);
      while (frames.next() != nullptr &&
             static_cast<std::uint64_t>(frames.next()->frame.wall_ns) <= time.wall_ns) {
        pass_frame();
      }
      visitor.tick(row, time);
      while (events.more() && events.time_s() <= time_s) {
        pass_event();
      }
      progress(static_cast<double>(rows.bytesRead()) / size);
    }
    while (frames.next() != nullptr) {
      pass_frame();
    }
    while (events.more()) {
      pass_event();
    }
  } catch (const std::invalid_argument& error) {
    throw app::FileError(ticks.string() + ": " + error.what());
  }
}

}  // namespace patella::convert
