// A finished run, second by second, as the messages that a live run sends to the page.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware_app/formats/run_messages.hpp"

namespace patella::view {

class Recording {
 public:
  /// Reads the folder of a run, and keeps its ticks in a temporary file without a name. `progress` is told
  /// which fraction is done. Throws std::runtime_error naming file and line, also for a run without a tick.
  Recording(const std::filesystem::path& run, const std::function<void(double fraction)>& progress);

  const std::vector<formats::ChannelDescription>& channels() const noexcept { return channels_; }
  std::size_t seconds() const noexcept { return seconds_.size(); }
  /// What the page has to know of the whole, JSON: times of the first and the last tick, seconds, events.
  std::string index() const;
  /// The messages of a second, each behind its length of 32 bits and framed as messageData() does, with the
  /// channel as its subscription. Throws std::runtime_error where the temporary file cannot be read.
  std::string messagesOf(std::size_t second) const;

 private:
  class Reader;
  struct Span {
    std::uint64_t start = 0;  ///< in the temporary file
    std::uint64_t size = 0;
  };
  struct Event {
    double time_s = 0.0;
    std::string line;
  };
  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  std::unique_ptr<std::FILE, Closer> file_;
  std::vector<formats::ChannelDescription> channels_;
  std::vector<Span> seconds_;
  std::vector<Event> events_;
  double start_s_ = 0.0;
  double end_s_ = 0.0;
};

}  // namespace patella::view
