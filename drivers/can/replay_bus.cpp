#include "drivers/can/replay_bus.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/stamp_order.hpp"
#include "drivers/joined.hpp"

namespace patella::can {
namespace {

std::string stampText(std::int64_t wall_ns) {
  constexpr std::int64_t kSecond_us = 1'000'000;
  const std::int64_t wall_us = wall_ns / 1000;
  const std::string fraction = std::to_string(kSecond_us + wall_us % kSecond_us).substr(1);
  return std::to_string(wall_us / kSecond_us) + "." + fraction;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const StampOrder::Jump& jump) {
  throw LogError(file.string() + ":" + std::to_string(jump.line) + ": the stamps jump from " +
                 stampText(jump.from_ns) + " to " + stampText(jump.to_ns) + ", expected at most " +
                 std::to_string(kLongestGap_s) + " s forward and " + std::to_string(kLongestStepBack_s) +
                 " s back in a log that is played by its stamps; cut it there, or mend them");
}

bool sameIdentifier(const Frame& a, const Frame& b) noexcept {
  return a.id == b.id && a.extended == b.extended && a.bus == b.bus;
}

bool sameContent(const Frame& a, const Frame& b) noexcept {
  return sameIdentifier(a, b) && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

// Of one bus, whatever its interface was called; of several, by name.
std::uint8_t busOf(const std::string& interface, const std::vector<std::string>& interfaces,
                   const std::string& place) {
  if (interfaces.size() <= 1)
    return 0;
  const auto found = std::find(interfaces.begin(), interfaces.end(), interface);
  if (found != interfaces.end())
    return static_cast<std::uint8_t>(found - interfaces.begin());
  throw LogError(place + ": a frame of interface '" + interface +
                 "', expected one of the configuration's: " + joined(interfaces, ", "));
}

enum class Role : std::uint8_t { kReceived, kSent, kCommand, kClosing };

Role roleOf(const Frame& frame, const ReplayOptions& options) {
  if (frame.error || frame.remote)
    return Role::kReceived;
  const auto same = [&frame](const Frame& known) { return sameContent(frame, known); };
  if (std::any_of(options.fixed_frames.begin(), options.fixed_frames.end(), same))
    return Role::kSent;
  if (options.command_id == frame.id && options.command_extended == frame.extended &&
      options.command_bus == frame.bus)
    return Role::kClosing;
  const auto known = [&frame](const Frame& sent) { return sameIdentifier(frame, sent); };
  return std::any_of(options.also_sent.begin(), options.also_sent.end(), known) ? Role::kCommand
                                                                                : Role::kReceived;
}

// Where a tick ended whose last command was lost, as that of a bus that is down: before the first frame that
// came after another drive's command. It shows once a tick begins anew with such a command.
class LostEnds {
 public:
  struct End {
    std::size_t command = 0, frames = 0;
  };
  /// Commands and frames so far, before this one. Returns the end that shows.
  std::optional<End> follow(Role role, std::size_t commands, std::size_t frames) {
    std::optional<End> shown;
    if (role == Role::kReceived && open_ && !end_)
      end_ = End{commands - 1, frames};
    if (role == Role::kCommand)
      shown = std::exchange(end_, std::nullopt);
    if (role == Role::kClosing)
      end_.reset();
    open_ = role == Role::kCommand || (open_ && role != Role::kClosing);
    return shown;
  }

 private:
  bool open_ = false;  ///< there was a command since a tick's last one
  std::optional<End> end_;
};

}  // namespace

ReplayBus::ReplayBus(const std::filesystem::path& file, const ReplayOptions& options) {
  CandumpReader reader(file);
  LogEntry entry;
  StampOrder stamps;
  Role last = Role::kReceived;
  LostEnds lost;
  while (reader.next(entry)) {
    entry.frame.bus =
        busOf(entry.interface, options.interfaces, file.string() + ":" + std::to_string(reader.line()));
    last = roleOf(entry.frame, options);
    stamps.follow(reader.line(), entry.frame.wall_ns);
    if (const auto end = lost.follow(last, commands_.size(), frames_.size())) {
      closing_.push_back(end->command);
      tick_end_.push_back(end->frames);
    }
    if (last == Role::kClosing) {
      closing_.push_back(commands_.size());
      tick_end_.push_back(frames_.size());
    }
    (last == Role::kReceived ? frames_ : commands_).push_back(entry.frame);
  }
  cut_line_ = reader.cutLine();
  // The loop's recorder ends every line: what has no end is part of a line, though it may read as a whole
  // one.
  if (cut_line_ == 0 && reader.unterminated() && !commands_.empty()) {
    cut_line_ = reader.line();
    (last == Role::kReceived ? frames_ : commands_).pop_back();
    if (last == Role::kClosing) {
      closing_.pop_back();
      tick_end_.pop_back();
    }
  }
  if (frames_.empty() && commands_.empty())
    throw LogError(file.string() + ": holds no frame");
  // A loop's own log is played tick by tick: its wall clock may have been set while it ran.
  if (commands_.empty() && stamps.firstJump())
    refuse(file, *stamps.firstJump());
  for (std::size_t i = 0; i < options.farewell_commands && tick_end_.size() > 1; ++i) {
    if (tick_end_.back() != frames_.size() || tick_end_[tick_end_.size() - 2] != frames_.size())
      break;
    tick_end_.pop_back();
    closing_.pop_back();
    commands_.resize(closing_.back() + 1);
  }
}

std::size_t ReplayBus::tickEnd() const noexcept {
  // The frames after the last command are one more tick.
  return ticks_begun_ <= tick_end_.size() ? tick_end_[ticks_begun_ - 1] : frames_.size();
}

std::size_t ReplayBus::deliver(std::span<Frame> frames, std::size_t end, std::int64_t now_ns) noexcept {
  const std::size_t count = std::min(frames.size(), end - next_frame_);
  for (std::size_t i = 0; i < count; ++i) {
    Frame& frame = frames[i];
    frame = frames_[next_frame_++];
    frame.monotonic_ns = hasCommands() ? now_ns : *start_ns_ + frame.wall_ns - frames_.front().wall_ns;
    errors_.observe(frame, statistics_[frame.bus]);
    if (!frame.error && !frame.own)
      ++statistics_[frame.bus].frames_received;
  }
  return count;
}

std::size_t ReplayBus::receive(std::span<Frame> frames, std::int64_t now_ns) noexcept {
  const bool new_tick = !start_ns_ || now_ns != tick_ns_;
  errors_.beginReceive();
  if (!start_ns_)
    start_ns_ = now_ns;
  tick_ns_ = now_ns;
  if (hasCommands()) {
    // A tick that did not fit is finished first, even if the caller has gone on.
    const bool pending = ticks_begun_ > 0 && next_frame_ < tickEnd();
    if (new_tick && !pending && ticks_begun_ <= tick_end_.size())
      ++ticks_begun_;
    return ticks_begun_ == 0 ? 0 : deliver(frames, tickEnd(), now_ns);
  }
  const std::int64_t until_wall_ns = frames_.front().wall_ns + (now_ns - *start_ns_);
  const auto begin = frames_.begin() + static_cast<std::ptrdiff_t>(next_frame_);
  const std::size_t wanted = std::min(frames.size(), frames_.size() - next_frame_);
  // A stamp may lie before its neighbour's, so frames wait for the first one that is not due.
  const auto due = std::find_if(begin, begin + static_cast<std::ptrdiff_t>(wanted),
                                [&](const Frame& frame) { return frame.wall_ns > until_wall_ns; });
  return deliver(frames, static_cast<std::size_t>(due - frames_.begin()), now_ns);
}

SendResult ReplayBus::send(Frame& frame, std::int64_t now_ns) noexcept {
  ++statistics_[frame.bus].frames_sent;
  frame.monotonic_ns = now_ns;
  if (next_command_ >= commands_.size()) {
    const Frame& first = frames_.empty() ? commands_.front() : frames_.front();
    frame.wall_ns = first.wall_ns + (now_ns - start_ns_.value_or(now_ns));
    return SendResult::kSent;
  }
  const Frame& recorded = commands_[next_command_];
  frame.wall_ns = recorded.wall_ns;
  command_mismatches_ += sameContent(frame, recorded) ? 0U : 1U;
  ++next_command_;
  return SendResult::kSent;
}

bool ReplayBus::exhausted() const noexcept {
  return next_frame_ == frames_.size() && (!hasCommands() || ticks_begun_ >= tick_end_.size());
}

}  // namespace patella::can
