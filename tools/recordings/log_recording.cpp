#include "tools/recordings/log_recording.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tools/recordings/held_torque.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

/// The torque that the log's loop commanded.
class CommandReader {
 public:
  CommandReader(const app::BusDescription& bus, int joints)
      : torque_Nm_(JointVector::Zero(joints)), encoder_(bus.database, bus.commands, joints) {
    for (const can::CommandMap& map : bus.commands) {
      Drive& drive =
          drives_.emplace_back(can::MessageDecoder(bus.database.message(map.message), map.protection));
      for (int joint = 0; joint < joints; ++joint) {
        const std::string name = "torque_Nm." + std::to_string(joint + 1);
        for (const can::Binding& binding : map.bindings) {
          if (binding.input == name) {
            drive.slots.push_back({joint, drive.decoder.slot(binding.signal), binding.scale, binding.offset});
          }
        }
      }
    }
  }

  bool matches(const can::Frame& frame) const noexcept { return encoder_.commands(frame); }

  /// Appends the torque of a frame that is not damaged; where each drive has its own, once the last has it.
  void accept(const can::Frame& frame) {
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      Drive& drive = drives_[i];
      if (!drive.decoder.matches(frame) || entersOrLeaves(i, frame)) {
        continue;
      }
      const can::FrameStatus status = drive.decoder.check(frame).status;
      if (status == can::FrameStatus::kCorrupt || status == can::FrameStatus::kTooShort) {
        continue;
      }
      for (const Slot& slot : drive.slots) {
        torque_Nm_[slot.joint] = slot.scale * drive.decoder.value(frame, slot.slot) + slot.offset;
      }
      if (i + 1 == drives_.size()) {
        commands.push_back({frame.wall_ns, torque_Nm_});
      }
    }
  }

  struct Command {
    std::int64_t wall_ns;
    JointVector torque_Nm;
  };
  std::vector<Command> commands;

 private:
  struct Slot {
    Eigen::Index joint;
    std::size_t slot;
    double scale;
    double offset;
  };
  struct Drive {
    explicit Drive(can::MessageDecoder message_decoder) : decoder(std::move(message_decoder)) {}
    can::MessageDecoder decoder;
    std::vector<Slot> slots;
  };

  bool entersOrLeaves(std::size_t drive, const can::Frame& frame) const {
    for (const auto which :
         {safety::DriveFrames::kEnter, safety::DriveFrames::kLeave, safety::DriveFrames::kClear}) {
      for (const can::Frame& fixed : encoder_.drive(drive).frames(which)) {
        if (fixed.id == frame.id && fixed.length == frame.length && fixed.data == frame.data) {
          return true;
        }
      }
    }
    return false;
  }

  JointVector torque_Nm_;
  can::CommandEncoder encoder_;
  std::vector<Drive> drives_;
};

std::set<std::string> positionMessages(const can::BusMap& map) {
  std::set<std::string> messages;
  for (const can::Binding& binding : map.bindings) {
    if (binding.input.starts_with("position_rad")) {
      messages.insert(binding.message);
    }
  }
  return messages;
}

class LogReading {
 public:
  LogReading(const std::filesystem::path& path, const app::BusDescription& bus, int joints)
      : path_(path),
        bus_(bus),
        decoder_(bus.database, bus.map, joints),
        command_(bus, joints),
        longest_burst_ns_(std::llround(0.5e9 * bus.map.encoder_period_s)) {
    recording_.name = path.string();
    recording_.joints = joints;
    recording_.rate_Hz = 1.0 / bus.map.encoder_period_s;
    for (const std::string& name : positionMessages(bus.map)) {
      const can::Message& message = bus.database.message(name);
      encoders_.emplace_back(message.id, message.extended);
    }
  }

  RawRecording read(bool sampled) {
    can::CandumpReader reader(path_);
    can::LogEntry entry;
    std::optional<std::int64_t> start_ns;
    while (reader.next(entry)) {
      can::Frame& frame = entry.frame;
      start_ns = start_ns.value_or(frame.wall_ns);
      frame.monotonic_ns = frame.wall_ns - *start_ns;
      frame.own = false;  // whoever recorded it
      now_ns_ = frame.monotonic_ns;
      if (command_.matches(frame)) {
        command_.accept(frame);
        continue;
      }
      if (sample_begun_ns_ && std::abs(frame.wall_ns - *sample_begun_ns_) > longest_burst_ns_) {
        closeSample();
      }
      if (!sample_begun_ns_ && isEncoder(frame)) {
        sample_begun_ns_ = frame.wall_ns;
      }
      decoder_.accept(frame);
    }
    closeSample();
    return finish(sampled);
  }

 private:
  bool isEncoder(const can::Frame& frame) const {
    return std::find(encoders_.begin(), encoders_.end(), std::pair{frame.id, frame.extended}) !=
           encoders_.end();
  }

  void closeSample() {
    const std::optional<std::int64_t> begun_ns = std::exchange(sample_begun_ns_, std::nullopt);
    const can::Reading reading = decoder_.finish(now_ns_);
    const Measurement& m = reading.measurement;
    if (m.encoder_steps == 0 || !begun_ns) {
      return;
    }
    samples_ += m.encoder_steps;
    if (!reading.complete) {
      return;
    }
    has_torque_ = m.has_drive_torque;
    has_emg_ = has_emg_ || m.emg_steps > 0;
    first_sample_ = recording_.stamp_s.empty() ? samples_ : first_sample_;
    begun_ns_.push_back(*begun_ns);
    recording_.stamp_s.push_back(static_cast<double>(samples_ - first_sample_) * bus_.map.encoder_period_s);
    for (std::size_t j = 0; j < static_cast<std::size_t>(recording_.joints); ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      recording_.position_rad[j].push_back(m.position_rad[joint]);
      recording_.torque_Nm[j].push_back(m.drive_torque_Nm[joint]);
      if (m.has_velocity) {
        recording_.velocity_rad_s[j].push_back(m.velocity_rad_s[joint]);
      }
    }
    for (std::size_t c = 0; c < kMaxEmgChannels; ++c) {
      recording_.emg_mV[c].push_back(m.emg_mV[c]);
    }
  }

  /// Gives each sample the newest command before the next one, and notes by how much it came later.
  void assignCommands(std::vector<double>& delay_s) {
    if (command_.commands.empty()) {
      return;
    }
    std::size_t next = 0;
    for (std::size_t row = 0; row < begun_ns_.size(); ++row) {
      const bool last = row + 1 == begun_ns_.size();
      while (next < command_.commands.size() &&
             (last || command_.commands[next].wall_ns < begun_ns_[row + 1])) {
        ++next;
      }
      const CommandReader::Command* newest = next == 0 ? nullptr : &command_.commands[next - 1];
      for (std::size_t j = 0; j < static_cast<std::size_t>(recording_.joints); ++j) {
        recording_.commanded_Nm[j].push_back(
            newest == nullptr ? 0.0 : newest->torque_Nm[static_cast<Eigen::Index>(j)]);
      }
      if (newest != nullptr && !last && newest->wall_ns >= begun_ns_[row]) {
        delay_s.push_back(1e-9 * static_cast<double>(newest->wall_ns - begun_ns_[row]));
      }
    }
  }

  RawRecording finish(bool sampled) {
    const std::string& name = recording_.name;
    if (recording_.rows() == 0) {
      throw app::FileError(
          name + ": no complete measurement, expected every input of the bus map in the log; " +
          std::to_string(decoder_.unknownFrames()) + " frames are of messages it does not bind");
    }
    std::vector<double> command_delay_s;
    assignCommands(command_delay_s);
    if (!has_emg_) {
      for (auto& signal : recording_.emg_mV) {
        signal.clear();
      }
    }
    if (!has_torque_) {
      if (command_.commands.empty()) {
        throw app::FileError(name +
                             ": holds neither the torque of a drive nor a command, expected one of them");
      }
      takeCommandsAsApplied(recording_);
    }
    warnOfLosses();
    if (sampled) {
      recording_.torque_timing = TorqueTiming::kSampled;
    } else {
      const double delay_s = command_delay_s.empty() ? 0.0 : offline::median(command_delay_s);
      alignHeldTorque(recording_, delay_s / bus_.map.encoder_period_s);
    }
    return std::move(recording_);
  }

  void warnOfLosses() {
    for (std::size_t i = 0; i < decoder_.messageCount(); ++i) {
      const can::MessageStatistics& s = decoder_.statistics(i);
      if (s.lost + s.corrupt + s.out_of_range > 0) {
        recording_.warnings.push_back(fmt::format("of {} frames {}: {} lost, {} corrupt, {} out of range",
                                                  s.received + s.lost, decoder_.messageName(i), s.lost,
                                                  s.corrupt, s.out_of_range));
      }
    }
  }

  std::filesystem::path path_;
  const app::BusDescription& bus_;
  can::MeasurementDecoder decoder_;
  CommandReader command_;
  std::vector<std::pair<std::uint32_t, bool>> encoders_;
  RawRecording recording_;
  std::int64_t longest_burst_ns_;                ///< between the first and the last message of one sample
  std::optional<std::int64_t> sample_begun_ns_;  ///< stamp of its first encoder frame
  std::vector<std::int64_t> begun_ns_;           ///< the same of every row
  std::int64_t samples_ = 0;
  std::int64_t first_sample_ = 0;
  std::int64_t now_ns_ = 0;
  bool has_torque_ = false;
  bool has_emg_ = false;
};

}  // namespace

RawRecording readLog(const std::filesystem::path& path, const app::BusDescription& bus, int joints,
                     bool sampled) {
  return LogReading(path, bus, joints).read(sampled);
}

}  // namespace patella::diagnose
