#include "sim/rig_messages.hpp"

#include <stdexcept>
#include <string>

namespace patella::sim {
namespace {

/// Of what a message of two joints carries.
constexpr int kJointsOfMessage = 2;

double ofJoint(const JointVector& v, Eigen::Index joint) noexcept {
  return joint < v.size() ? v(joint) : 0.0;
}

can::Protection protectionOf(const can::Message& message) {
  if (message.find("Counter") == nullptr || message.find("Crc") == nullptr) {
    return {};
  }
  return {message.name, "Counter", "Crc"};
}

std::vector<OutgoingMessage> encoderMessages(const can::Database& database, int joints) {
  std::vector<OutgoingMessage> messages;
  for (int joint = 1; joint <= joints; ++joint) {
    messages.emplace_back(database, "Encoder" + std::to_string(joint),
                          std::initializer_list<std::string_view>{"Position", "Velocity"});
  }
  return messages;
}

std::vector<OutgoingMessage> truthMessages(const can::Database& database, int joints) {
  std::vector<OutgoingMessage> messages;
  for (int first = 1; first <= joints; first += kJointsOfMessage) {
    const std::string name = first == 1 ? "Truth" : "Truth" + std::to_string(first / kJointsOfMessage + 1);
    const std::string signals[] = {"Fu" + std::to_string(first), "Fu" + std::to_string(first + 1)};
    messages.emplace_back(database, name, std::initializer_list<std::string_view>{signals[0], signals[1]});
  }
  return messages;
}

}  // namespace

OutgoingMessage::OutgoingMessage(const can::Database& database, std::string_view message,
                                 std::initializer_list<std::string_view> signals)
    : encoder_(database.message(message), protectionOf(database.message(message))) {
  for (const std::string_view signal : signals) {
    slots_.push_back(encoder_.slot(signal));
  }
}

can::Frame OutgoingMessage::make(std::initializer_list<double> values) noexcept PATELLA_NONBLOCKING {
  can::Frame frame = encoder_.blank();
  auto slot = slots_.begin();
  for (const double value : values) {
    encoder_.set(frame, *slot++, value);
  }
  encoder_.seal(frame);
  return frame;
}

RigMessages::RigMessages(const can::Database& database, int joints, bool field_drives)
    : operator_(database, "Operator", {"Enable", "Reset"}) {
  if (!field_drives && joints > kJointsOfMessage) {
    throw std::invalid_argument("rig: " + std::to_string(joints) +
                                " joints, expected a rig.drive_model for each: DriveStatus and TorqueCommand "
                                "are for two");
  }
  if (!field_drives || database.find("Emg") != nullptr) {
    emg_.emplace(database, "Emg",
                 std::initializer_list<std::string_view>{"Channel1", "Channel2", "Channel3", "Channel4"});
  }
  if (!field_drives || database.find("Truth") != nullptr) {
    truth_ = truthMessages(database, joints);
  }
  if (field_drives) {
    return;
  }
  encoders_ = encoderMessages(database, joints);
  drive_status_.emplace(database, "DriveStatus",
                        std::initializer_list<std::string_view>{"Torque1", "Torque2", "Enabled", "Fault"});
  // A drive obeys only commands that are guarded.
  command_.emplace(database.message("TorqueCommand"), can::Protection{"TorqueCommand", "Counter", "Crc"});
  command_enable_ = command_->slot("Enable");
  for (int joint = 1; joint <= joints; ++joint) {
    command_torques_.push_back(command_->slot("Torque" + std::to_string(joint)));
  }
}

can::Frame RigMessages::encoder(std::size_t joint, double position_rad,
                                double velocity_rad_s) noexcept PATELLA_NONBLOCKING {
  return encoders_[joint].make({position_rad, velocity_rad_s});
}

can::Frame RigMessages::driveStatus(const JointVector& torque_Nm, bool enabled,
                                    DriveFault fault) noexcept PATELLA_NONBLOCKING {
  return drive_status_->make(
      {torque_Nm(0), ofJoint(torque_Nm, 1), enabled ? 1.0 : 0.0, static_cast<double>(fault)});
}

can::Frame RigMessages::emg(const EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING {
  return emg_->make({signal_mV[0], signal_mV[1], signal_mV[2], signal_mV[3]});
}

can::Frame RigMessages::truth(std::size_t index, const JointVector& f_u_rad_s2) noexcept PATELLA_NONBLOCKING {
  const auto first = static_cast<Eigen::Index>(index) * kJointsOfMessage;
  return truth_[index].make({ofJoint(f_u_rad_s2, first), ofJoint(f_u_rad_s2, first + 1)});
}

can::Frame RigMessages::operatorButtons(bool enable, bool reset) noexcept PATELLA_NONBLOCKING {
  return operator_.make({enable ? 1.0 : 0.0, reset ? 1.0 : 0.0});
}

bool RigMessages::decodeCommand(const can::Frame& frame, JointVector& torque_Nm,
                                bool& enable) noexcept PATELLA_NONBLOCKING {
  if (command_->check(frame).status != can::FrameStatus::kUsable) {
    return false;
  }
  for (std::size_t joint = 0; joint < command_torques_.size(); ++joint) {
    torque_Nm(static_cast<Eigen::Index>(joint)) = command_->value(frame, command_torques_[joint]);
  }
  enable = command_->value(frame, command_enable_) != 0.0;
  return true;
}

void RigMessages::restart() noexcept {
  for (OutgoingMessage& encoder : encoders_) {
    encoder.restart();
  }
  for (OutgoingMessage& truth : truth_) {
    truth.restart();
  }
  for (std::optional<OutgoingMessage>* message : {&drive_status_, &emg_}) {
    if (*message) {
      (*message)->restart();
    }
  }
  operator_.restart();
}

}  // namespace patella::sim
