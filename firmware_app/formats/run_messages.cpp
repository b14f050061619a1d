#include "firmware_app/formats/run_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "drivers/joined.hpp"
#include "firmware_app/formats/frame_bits.hpp"
#include "firmware_app/formats/ros2_definitions.hpp"

namespace patella::formats {
namespace {

constexpr std::size_t kClassicBytes = 8;

std::string_view bytesOf(const can::Frame& frame, std::size_t count) {
  return {reinterpret_cast<const char*>(frame.data.data()), count};
}

void header(CdrWriter& out, std::uint64_t wall_ns, std::string_view frame_id) {
  out.time(wall_ns);
  out.text(frame_id);
}

// What half, 99 % and 99.9 % of the values do not exceed, and the largest.
void quantiles(CdrWriter& out, std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  for (const double quantile : {0.5, 0.99, 0.999, 1.0}) {
    const auto index = static_cast<std::size_t>(std::max(std::ceil(quantile * count) - 1.0, 0.0));
    out.put(values.empty() ? std::numeric_limits<double>::quiet_NaN() : values[index]);
  }
}

// Two buckets an octave: 1, 1.41, 2, 2.83 µs and on. `sorted` from the smallest.
void histogram(CdrWriter& out, const std::vector<double>& sorted) {
  std::vector<double> ends_us;
  std::vector<std::uint32_t> counts;
  for (const double value : sorted) {
    const double end_us = std::exp2(0.5 * std::ceil(2.0 * std::log2(std::max(value, 1.0))));
    if (ends_us.empty() || end_us > ends_us.back()) {
      ends_us.push_back(end_us);
      counts.push_back(0);
    }
    ++counts.back();
  }
  out.length(ends_us.size());
  for (const double end_us : ends_us) {
    out.put(end_us);
  }
  out.length(counts.size());
  for (const std::uint32_t count : counts) {
    out.put(count);
  }
}

}  // namespace

RunMessages::RunMessages(std::vector<std::string> columns)
    : columns_(std::move(columns)),
      fields_(tickFields(columns_)),
      time_(find("t_s")),
      wakeup_(find("wakeup_us")),
      execution_(find("execution_us")),
      missed_(find("missed_periods")),
      position_(perJoint("q", "rad")),
      velocity_(perJoint("dq", "rad_s")),
      torque_(perJoint("tau", "Nm")) {
  if (!time_) {
    throw std::invalid_argument("no column 't_s', expected those of a run's ticks.csv");
  }
}

std::optional<std::size_t> RunMessages::find(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  return found == columns_.end() ? std::nullopt
                                 : std::optional(static_cast<std::size_t>(found - columns_.begin()));
}

std::vector<std::size_t> RunMessages::perJoint(std::string_view stem, std::string_view unit) const {
  std::vector<std::size_t> indices;
  while (const auto index =
             find(std::string(stem) + std::to_string(indices.size() + 1) + "_" + std::string(unit))) {
    indices.push_back(*index);
  }
  return indices;
}

std::vector<ChannelDescription> RunMessages::channels() const {
  return {{std::string(kTickTopic), std::string(kTickType), tickDefinition(fields_), joined(columns_, ",")},
          {"/joint_states", "sensor_msgs/msg/JointState", jointStateDefinition(), ""},
          {"/patella/events", "rcl_interfaces/msg/Log", logDefinition(), ""},
          {"/patella/timing", "patella_msgs/msg/Timing", timingDefinition(), ""},
          {"/patella/can", "can_msgs/msg/Frame", canFrameDefinition(), ""},
          {"/patella/can_fd", "patella_msgs/msg/CanFdFrame", canFdFrameDefinition(), ""}};
}

void RunMessages::tick(std::span<const double> row, const MessageTime& time, const Sink& sink) {
  const double t_s = row[*time_];
  if (second_ && second_->ticks > 0 && std::floor(t_s) > std::floor(second_->start_s)) {
    timing(sink);
  }
  if (!second_ || second_->ticks == 0) {
    second_ = second_.value_or(Second{});
    second_->start_s = std::floor(t_s);
  }
  newest_ = time;
  ++second_->ticks;
  const auto add = [&](std::vector<double>& values, std::optional<std::size_t> column) {
    if (column && std::isfinite(row[*column])) {
      values.push_back(row[*column]);
    }
  };
  add(second_->wakeup_us, wakeup_);
  add(second_->execution_us, execution_);
  second_->missed_periods += missed_ ? static_cast<std::uint32_t>(row[*missed_]) : 0U;

  message_.clear();
  encodeTick(message_, fields_, row);
  sink(RunChannel::kTick, time, message_.bytes());

  message_.clear();
  header(message_, time.wall_ns, "");
  message_.length(position_.size());
  for (std::size_t joint = 0; joint < position_.size(); ++joint) {
    message_.text("joint_" + std::to_string(joint + 1));
  }
  for (const auto* indices : {&position_, &velocity_, &torque_}) {
    message_.length(indices->size());
    for (const std::size_t index : *indices) {
      message_.put(row[index]);
    }
  }
  sink(RunChannel::kJointStates, time, message_.bytes());
}

void RunMessages::frame(const can::Frame& frame, std::string_view interface, const MessageTime& time,
                        const Sink& sink) {
  second_ = second_.value_or(Second{});
  ++second_->frames;
  second_->frame_bits += frameBits(frame);
  message_.clear();
  header(message_, time.wall_ns, interface);
  message_.put(frame.id);
  if (frame.fd) {
    message_.boolean(frame.extended);
    message_.boolean(frame.error);
    message_.boolean(frame.bit_rate_switch);
    message_.length(frame.length);
    message_.raw(bytesOf(frame, frame.length));
    sink(RunChannel::kCanFd, time, message_.bytes());
    return;
  }
  message_.boolean(frame.remote);
  message_.boolean(frame.extended);
  message_.boolean(frame.error);
  message_.put(frame.length);
  message_.raw(bytesOf(frame, kClassicBytes));
  sink(RunChannel::kCan, time, message_.bytes());
}

void RunMessages::event(std::string_view line, const MessageTime& time, const Sink& sink) {
  constexpr std::uint8_t kInfo = 20;
  constexpr std::uint8_t kWarning = 30;
  constexpr std::uint8_t kError = 40;
  const auto says = [&](std::string_view word) { return line.find(word) != std::string_view::npos; };
  const bool warns = says(" warning=") || says(" missed_periods=");
  message_.clear();
  message_.time(time.wall_ns);
  message_.put(says(" raised=") ? kError : warns ? kWarning : kInfo);
  message_.text("patella");
  message_.text(line);
  message_.text("");
  message_.text("");
  message_.put(std::uint32_t{0});
  sink(RunChannel::kEvents, time, message_.bytes());
}

void RunMessages::timing(const Sink& sink) {
  message_.clear();
  message_.put(second_->start_s);
  message_.put(second_->ticks);
  message_.put(second_->missed_periods);
  message_.put(second_->frames);
  message_.put(second_->frame_bits);
  quantiles(message_, second_->wakeup_us);
  quantiles(message_, second_->execution_us);
  histogram(message_, second_->wakeup_us);
  histogram(message_, second_->execution_us);
  sink(RunChannel::kTiming, newest_, message_.bytes());
  second_.reset();
}

void RunMessages::end(const Sink& sink) {
  if (second_ && second_->ticks > 0) {
    timing(sink);
  }
}

}  // namespace patella::formats
