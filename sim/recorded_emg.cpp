#include "sim/recorded_emg.hpp"

#include <array>
#include <string>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/message_codec.hpp"

namespace patella::sim {

RecordedEmg::RecordedEmg(const std::filesystem::path& log, const can::Database& database) {
  can::MessageDecoder decoder(database.message("Emg"),
                              {.message = "Emg", .counter_signal = "Counter", .crc_signal = "Crc"});
  std::array<std::size_t, kMaxEmgChannels> slots{};
  for (std::size_t channel = 0; channel < slots.size(); ++channel) {
    slots[channel] = decoder.slot("Channel" + std::to_string(channel + 1));
  }
  can::CandumpReader reader(log);
  can::LogEntry entry;
  std::int64_t start_ns = 0;
  while (reader.next(entry)) {
    if (!decoder.matches(entry.frame) || decoder.check(entry.frame).status != can::FrameStatus::kUsable) {
      continue;
    }
    if (samples_.empty()) {
      start_ns = entry.frame.wall_ns;
    }
    Sample sample{.elapsed_ns = entry.frame.wall_ns - start_ns, .signal_mV = {}};
    if (!samples_.empty() && sample.elapsed_ns < samples_.back().elapsed_ns) {
      throw can::LogError(log.string() + ":" + std::to_string(reader.line()) +
                          ": stamp goes back, expected EMG in order of time");
    }
    for (std::size_t channel = 0; channel < slots.size(); ++channel) {
      sample.signal_mV[channel] = decoder.value(entry.frame, slots[channel]);
    }
    samples_.push_back(sample);
  }
  if (samples_.empty()) {
    throw can::LogError(log.string() + ": holds no usable frame of message Emg, expected at least one");
  }
}

const EmgArray& RecordedEmg::at(std::int64_t elapsed_ns) noexcept PATELLA_NONBLOCKING {
  while (newest_ + 1 < samples_.size() && samples_[newest_ + 1].elapsed_ns <= elapsed_ns) {
    ++newest_;
  }
  return samples_[newest_].signal_mV;
}

}  // namespace patella::sim
