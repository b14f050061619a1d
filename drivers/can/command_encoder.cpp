#include "drivers/can/command_encoder.hpp"

#include <stdexcept>
#include <string>

#include "drivers/can/binding_check.hpp"

namespace patella::can {

CommandEncoder::CommandEncoder(const Database& database, const CommandMap& map, int joints)
    : encoder_(database.message(map.message), map.protection), joints_(joints) {
  if (joints < 1 || joints > kMaxJoints) {
    throw std::invalid_argument("number of joints is " + std::to_string(joints) + ", expected 1 to " +
                                std::to_string(kMaxJoints));
  }
  checkBindings(database, {}, {&map, 1});
  for (const Binding& binding : map.bindings) {
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
    for (int joint = 0; joint < joints_; ++joint) {
      if (binding.input == "torque_Nm." + std::to_string(joint + 1)) {
        output = &torques_[static_cast<std::size_t>(joint)];
      }
    }
    if (output == nullptr) {
      throw std::invalid_argument(quoted + " is unknown; there are: torque_Nm.1 to torque_Nm." +
                                  std::to_string(joints_) + ", enable, state");
    }
    try {
      *output = Output{encoder_.slot(binding.signal), binding.scale, binding.offset};
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(quoted + ": " + error.what());
    }
  }
  for (int joint = 0; joint < joints_; ++joint) {
    if (!torques_[static_cast<std::size_t>(joint)]) {
      throw std::invalid_argument("no signal is bound to output 'torque_Nm." + std::to_string(joint + 1) +
                                  "'");
    }
  }
}

void CommandEncoder::put(Frame& frame, const std::optional<Output>& output, double value) const noexcept {
  if (output)
    encoder_.set(frame, output->slot, (value - output->offset) / output->scale);
}

Frame CommandEncoder::encode(const Command& command) noexcept {
  Frame frame = encoder_.blank();
  const bool finite = command.torque_Nm.allFinite();
  for (int joint = 0; joint < joints_; ++joint) {
    put(frame, torques_[static_cast<std::size_t>(joint)], finite ? command.torque_Nm[joint] : 0.0);
  }
  put(frame, enable_, command.enable && finite ? 1.0 : 0.0);
  put(frame, state_, static_cast<double>(command.state));
  encoder_.seal(frame);
  return frame;
}

}  // namespace patella::can
