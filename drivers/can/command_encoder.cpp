#include "drivers/can/command_encoder.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "drivers/can/binding_check.hpp"
#include "drivers/can/named_binding.hpp"

namespace patella::can {

DriveCommand::DriveCommand(const Database& database, const CommandMap& map, int joints)
    : encoder_(database.message(map.message), map.protection), blank_(encoder_.blank()) {
  for (const Constant& constant : map.constants) {
    encoder_.set(blank_, encoder_.slot(constant.signal), constant.value);
  }
  for (const Binding& binding : map.bindings) {
    bind(map, binding, joints);
  }
  if (map.node != 0) {
    node_ = map.node;
    controlword_ = Output{encoder_.slot(map.controlword), 1.0, 0.0};
  }
  enter_ = fixed(database, map, map.enter);
  leave_ = fixed(database, map, map.leave);
  clear_ = fixed(database, map, map.clear);
  requireBound(boundOf("command.enter_period_s"), map.enter_period_s);
  requireBound(boundOf("command.enter_timeout_s"), map.enter_timeout_s);
  if (map.enter_time_s != 0.0) {
    requireBound(boundOf("command.enter_time_s"), map.enter_time_s);
  }
  entry_ = {.needed = !enter_.empty() || node_ != 0,
            .joints = {},
            .period_s = map.enter_period_s,
            .timeout_s = map.enter_timeout_s,
            .blind_s = map.enter_time_s};
  for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
    entry_.joints[joint] = torques_[joint].has_value();
  }
}

void DriveCommand::bind(const CommandMap& map, const Binding& binding, int joints) {
  const std::string quoted = "output '" + binding.input + "'";
  if (!binding.message.empty() && binding.message != map.message) {
    throw std::invalid_argument(quoted + " is bound to message '" + binding.message +
                                "', expected the command message '" + map.message + "'");
  }
  requireBound(boundOf("command.output.scale"), binding.scale, quoted + ": scale");
  requireBound(boundOf("command.output.offset"), binding.offset, quoted + ": offset");
  std::optional<Output>* output = nullptr;
  if (binding.input == "enable")
    output = &enable_;
  if (binding.input == "state")
    output = &state_;
  for (int joint = 0; joint < joints; ++joint) {
    if (binding.input == "torque_Nm." + std::to_string(joint + 1)) {
      output = &torques_[static_cast<std::size_t>(joint)];
    }
  }
  if (output == nullptr) {
    throw std::invalid_argument(quoted + " is unknown; there are: torque_Nm.1 to torque_Nm." +
                                std::to_string(joints) + ", enable, state");
  }
  try {
    *output = Output{encoder_.slot(binding.signal), binding.scale, binding.offset};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(quoted + ": " + error.what());
  }
}

std::vector<Frame> DriveCommand::fixed(const Database& database, const CommandMap& map,
                                       const std::vector<FixedFrame>& frames) const {
  std::vector<Frame> result;
  for (const FixedFrame& fixed : frames) {
    const Message& message = database.message(fixed.message.empty() ? map.message : fixed.message);
    Frame frame = CompiledMessage(message, {}).blank();
    std::copy(fixed.data.begin(), fixed.data.end(), frame.data.begin());
    result.push_back(frame);
  }
  return result;
}

std::span<const Frame> DriveCommand::frames(safety::DriveFrames which) const noexcept {
  switch (which) {
    case safety::DriveFrames::kEnter:
      return enter_;
    case safety::DriveFrames::kLeave:
      return leave_;
    case safety::DriveFrames::kClear:
      return clear_;
    case safety::DriveFrames::kNone:
      break;
  }
  return {};
}

void DriveCommand::put(Frame& frame, const std::optional<Output>& output, double value) const noexcept {
  if (output)
    encoder_.set(frame, output->slot, (value - output->offset) / output->scale);
}

bool DriveCommand::carries(int joint, double torque_Nm) const noexcept {
  const Output& output = *torques_[static_cast<std::size_t>(joint)];
  const double value = (torque_Nm - output.offset) / output.scale;
  Frame frame = blank_;
  return layout().signal(output.slot).inRange(value) && encoder_.set(frame, output.slot, value);
}

Frame DriveCommand::encode(const Command& command, std::uint16_t controlword) const noexcept {
  Frame frame = blank_;
  const bool finite = command.torque_Nm.allFinite();
  for (Eigen::Index joint = 0; joint < command.torque_Nm.size(); ++joint) {
    put(frame, torques_[static_cast<std::size_t>(joint)], finite ? command.torque_Nm[joint] : 0.0);
  }
  put(frame, enable_, command.enable && finite ? 1.0 : 0.0);
  put(frame, state_, static_cast<double>(command.state));
  put(frame, controlword_, finite ? controlword : 0.0);
  return frame;
}

CommandEncoder::CommandEncoder(const Database& database, std::span<const CommandMap> maps, int joints) {
  if (joints < 1 || joints > kMaxJoints) {
    throw std::invalid_argument("number of joints is " + std::to_string(joints) + ", expected 1 to " +
                                std::to_string(kMaxJoints));
  }
  checkCommands(database, maps);
  for (const CommandMap& map : maps) {
    drives_.emplace_back(database, map, joints);
  }
  for (int joint = 0; joint < joints; ++joint) {
    if (std::none_of(drives_.begin(), drives_.end(),
                     [joint](const DriveCommand& drive) { return drive.moves(joint); })) {
      throw std::invalid_argument("no signal is bound to output 'torque_Nm." + std::to_string(joint + 1) +
                                  "'");
    }
  }
  for (const DriveCommand& drive : drives_) {
    if (std::none_of(drive.entry().joints.begin(), drive.entry().joints.end(), [](bool is) { return is; })) {
      throw std::invalid_argument("command '" + drive.layout().name() +
                                  "' moves no joint, expected an output torque_Nm.<number> in it");
    }
    note(drive.layout().blank());
    for (const safety::DriveFrames which :
         {safety::DriveFrames::kEnter, safety::DriveFrames::kLeave, safety::DriveFrames::kClear}) {
      for (const Frame& frame : drive.frames(which)) {
        note(frame);
      }
    }
  }
}

void CommandEncoder::requireTorque(const safety::SafetyLimits& limits) const {
  for (const DriveCommand& drive : drives_) {
    for (int joint = 0; joint < kMaxJoints; ++joint) {
      const double limit_Nm = limits.joint[static_cast<std::size_t>(joint)].torque_Nm;
      if (drive.moves(joint) && !(drive.carries(joint, limit_Nm) && drive.carries(joint, -limit_Nm))) {
        throw std::invalid_argument("output 'torque_Nm." + std::to_string(joint + 1) + "' of message '" +
                                    drive.layout().name() + "' does not carry ±" + digits(limit_Nm) +
                                    " N·m, expected the limit of safety.torque_Nm within its signal's range");
      }
    }
  }
}

void CommandEncoder::note(const Frame& frame) {
  const Identifier identifier{frame.id, frame.extended, frame.bus};
  if (std::find(identifiers_.begin(), identifiers_.end(), identifier) == identifiers_.end()) {
    identifiers_.push_back(identifier);
  }
}

bool CommandEncoder::commands(const Frame& frame) const noexcept {
  return !frame.error && !frame.remote &&
         std::find(identifiers_.begin(), identifiers_.end(),
                   Identifier{frame.id, frame.extended, frame.bus}) != identifiers_.end();
}

std::vector<safety::DriveEntrySettings> CommandEncoder::entries() const {
  std::vector<safety::DriveEntrySettings> entries;
  for (const DriveCommand& drive : drives_) {
    entries.push_back(drive.entry());
  }
  return entries;
}

}  // namespace patella::can
