// A rig that sends its messages by name, and a decoder to take them.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/rig_map.hpp"

namespace patella::can::test {

inline constexpr std::int64_t kMillisecond = 1'000'000;
inline constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;

/// Sends the rig's messages by name; counters run on, so a frame that is made and not delivered is a lost
/// one.
class Rig {
 public:
  using Values = std::vector<std::pair<const char*, double>>;

  Frame make(const std::string& name, std::int64_t time_ns, const Values& values) {
    for (auto& [known, encoder] : encoders_) {
      if (known == name)
        return fill(encoder, time_ns, values);
    }
    const Protection protection = name == "Truth" ? Protection{} : protectionOf(name);
    encoders_.emplace_back(name, MessageEncoder(database_.message(name), protection));
    return fill(encoders_.back().second, time_ns, values);
  }

  const Database& database() const { return database_; }

 private:
  static Frame fill(MessageEncoder& encoder, std::int64_t time_ns, const Values& values) {
    Frame frame = encoder.blank();
    for (const auto& [signal, value] : values)
      encoder.set(frame, encoder.slot(signal), value);
    encoder.seal(frame);
    frame.monotonic_ns = time_ns;
    frame.wall_ns = kEpoch + time_ns;
    return frame;
  }

  Database database_ = rigDatabase();
  std::vector<std::pair<std::string, MessageEncoder>> encoders_;
};

struct Fixture {
  explicit Fixture(const BusMap& map = rigMap()) : decoder(rig.database(), map, 2) {}

  void encoders(std::int64_t time_ns, double hip_rad, double knee_rad) {
    decoder.accept(rig.make("Encoder1", time_ns, {{"Position", hip_rad}, {"Velocity", 1.0}}));
    decoder.accept(rig.make("Encoder2", time_ns, {{"Position", knee_rad}, {"Velocity", -2.0}}));
  }
  void others(std::int64_t time_ns) {
    decoder.accept(rig.make("DriveStatus", time_ns, {{"Torque1", 3.0}, {"Torque2", -4.0}, {"Enabled", 1}}));
    decoder.accept(rig.make("Emg", time_ns, {{"Channel1", 0.3}, {"Channel2", -0.6}}));
    decoder.accept(rig.make("Operator", time_ns, {{"Enable", 1}, {"Reset", 1}}));
  }
  const MessageStatistics& statistics(const std::string& name) const {
    for (std::size_t i = 0; i < decoder.messageCount(); ++i) {
      if (decoder.messageName(i) == name)
        return decoder.statistics(i);
    }
    throw std::invalid_argument(name);
  }

  Rig rig;
  MeasurementDecoder decoder;
};

}  // namespace patella::can::test
