#include "firmware_app/configuration/fault_script_file.hpp"

#include <numbers>
#include <string>

#include "firmware_app/files/bounded.hpp"

namespace patella::app {
namespace {

using sim::ChannelGroup;
using sim::FaultEvent;
using sim::FaultKind;
using Names = std::vector<std::string>;

Names kindNames() {
  Names names;
  for (int i = 0; i < sim::kFaultKindCount; ++i) {
    names.emplace_back(sim::faultKindName(static_cast<FaultKind>(i)));
  }
  return names;
}

Names numbered(const std::string& stem, int count) {
  Names names;
  for (int i = 1; i <= count; ++i) {
    names.push_back(stem + std::to_string(i));
  }
  return names;
}

/// In the order of their numbers.
Names channelNames(ChannelGroup group, int joints) {
  Names names;
  switch (group) {
    case ChannelGroup::kFrames:
      for (int i = 0; i < sim::kFrameChannelCount; ++i) {
        names.emplace_back(sim::frameChannelName(static_cast<sim::FrameChannel>(i)));
      }
      return names;
    case ChannelGroup::kEncoder:
      return numbered("encoder", joints);
    case ChannelGroup::kEmg:
      return numbered("emg", kMaxEmgChannels);
    case ChannelGroup::kDrive:
      return numbered("drive", joints);
    case ChannelGroup::kNone:
      break;
  }
  return names;
}

int indexOf(const Names& names, const std::string& name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) {
      return static_cast<int>(i);
    }
  }
  return FaultEvent::kAll;
}

void readChannel(const TomlTable& table, int joints, FaultEvent& event) {
  const ChannelGroup group = sim::channelGroup(event.kind);
  if (group == ChannelGroup::kNone) {
    return;
  }
  const Names names = channelNames(group, joints);
  Names allowed = names;
  allowed.emplace_back("all");
  event.channel = indexOf(names, table.choice("channel", allowed, "all"));
}

void readFrameParameters(const TomlTable& table, FaultEvent& event) {
  event.probability = number(table, boundOf("fault.probability"), event.probability);
  if (event.kind == FaultKind::kDelayedFrames) {
    event.delay_s = number(table, boundOf("fault.delay_s"), event.delay_s);
  }
  if (event.kind == FaultKind::kFlippedBits) {
    readInteger(table, boundOf("fault.bits"), event.bits);
  }
  if (event.kind == FaultKind::kForgedFrames) {
    event.value = number(table, boundOf("fault.value"));
    event.counter_correct = table.choice("counter", Names{"next", "same"}, "next") == "next";
    event.crc_correct = table.choice("crc", Names{"right", "wrong"}, "right") == "right";
  }
}

void readParameters(const TomlTable& table, FaultEvent& event) {
  switch (event.kind) {
    case FaultKind::kEncoderJump:
      event.value = number(table, boundOf("fault.offset_rad"));
      break;
    case FaultKind::kEncoderDrift:
      event.value = number(table, boundOf("fault.rate_rad_s"));
      break;
    case FaultKind::kEncoderWrap:
      event.value = number(table, boundOf("fault.turn_rad"), 2.0 * std::numbers::pi);
      break;
    case FaultKind::kEncoderFreeze:
      event.with_velocity = table.boolean("with_velocity", true);
      break;
    case FaultKind::kEmgSaturation:
      event.value = number(table, boundOf("fault.level_mV"), 1.5);
      break;
    case FaultKind::kEmgDisconnection:
      event.value = number(table, boundOf("fault.noise_mV"), 0.0);
      break;
    case FaultKind::kEmgHum:
      event.value = number(table, boundOf("fault.amplitude_mV"));
      event.frequency_Hz = number(table, boundOf("fault.frequency_Hz"), event.frequency_Hz);
      break;
    case FaultKind::kDriveNotFollowing:
      event.value = number(table, boundOf("fault.gain"), 0.0);
      break;
    case FaultKind::kDriveOverTorque:
      event.value = number(table, boundOf("fault.extra_Nm"));
      break;
    case FaultKind::kClockStep:
      event.value = number(table, boundOf("fault.step_s"));
      break;
    case FaultKind::kGpioBounce:
      event.value = number(table, boundOf("fault.period_s"), 0.002);
      break;
    case FaultKind::kMemoryPressure:
      event.value = number(table, boundOf("fault.size_MB"));
      break;
    default:
      break;
  }
}

void requireStage(const TomlTable& table, const FaultEvent& event, FaultStage stage) {
  const std::string kind(sim::faultKindName(event.kind));
  if (stage == FaultStage::kRig && sim::actsOnLoop(event.kind)) {
    throw table.error("kind", "value '" + kind +
                                  "', expected a fault of the rig: this one happens to the loop's host, "
                                  "give it to patella run --faults");
  }
  if (stage == FaultStage::kLoop && !sim::actsOnLoop(event.kind)) {
    throw table.error("kind", "value '" + kind +
                                  "', expected a fault of the loop's host: this one happens in the rig, "
                                  "give it to patella-rig --faults, or use the backend sim");
  }
}

// A fault that comes and goes has both; a bounce does so by itself.
void readCycle(const TomlTable& table, FaultEvent& event) {
  if (event.kind == FaultKind::kGpioBounce) {
    return;
  }
  if (table.has("cycle_s") || table.has("duty")) {
    event.cycle_s = number(table, boundOf("fault.cycle_s"));
    event.duty = number(table, boundOf("fault.duty"));
  }
}

void readStage(const TomlTable& table, FaultEvent& event) {
  if (event.kind != FaultKind::kLoopStall) {
    return;
  }
  Names stages{"between"};
  stages.insert(stages.end(), tick::kStageNames.begin(), tick::kStageNames.end());
  const int stage = indexOf(stages, table.choice("stage", stages, "between"));
  if (stage > 0) {
    event.stage = static_cast<tick::Stage>(stage - 1);
  }
}

FaultEvent readFault(const TomlTable& table, FaultStage stage, int joints, const Names& buses) {
  const Names kinds = kindNames();
  FaultEvent event;
  event.kind = static_cast<FaultKind>(indexOf(kinds, table.choice("kind", kinds)));
  requireStage(table, event, stage);
  event.time_s = number(table, boundOf("fault.time_s"));
  if (table.has("duration_s")) {
    event.duration_s = number(table, boundOf("fault.duration_s"));
  } else if (event.kind == FaultKind::kLoopStall || event.kind == FaultKind::kRigStall ||
             event.kind == FaultKind::kPeerRestart) {
    event.duration_s = number(table, boundOf("fault.duration_s"));  // says that it is missing
  }
  readCycle(table, event);
  readStage(table, event);
  readChannel(table, joints, event);
  if (sim::actsOnBus(event.kind) && buses.size() > 1 && table.has("bus")) {
    event.bus = indexOf(buses, table.choice("bus", buses));
  }
  if (sim::channelGroup(event.kind) == ChannelGroup::kFrames) {
    readFrameParameters(table, event);
  }
  readParameters(table, event);
  return event;
}

}  // namespace

std::vector<sim::FaultEvent> loadFaultScript(const std::filesystem::path& path, FaultStage stage, int joints,
                                             const std::vector<std::string>& buses) {
  const TomlDocument document = TomlDocument::load(path);
  std::vector<sim::FaultEvent> events;
  for (const TomlTable& table : document.root().tables("fault")) {
    events.push_back(readFault(table, stage, joints, buses));
  }
  document.finish();
  if (events.empty()) {
    throw FileError(path.string() + ": holds no fault, expected [[fault]] tables");
  }
  return events;
}

}  // namespace patella::app
