#include "sim/rig_messages.hpp"

#include <stdexcept>
#include <string>

#include "drivers/can/crc8.hpp"

namespace patella::sim {
namespace {

constexpr int kByteBits = 8;

double second(const JointVector& v) noexcept {
  return v.size() > 1 ? v(1) : 0.0;
}

std::vector<RigMessage> encoderMessages(const can::Database& database, int joints) {
  std::vector<RigMessage> messages;
  for (int joint = 1; joint <= joints; ++joint) {
    messages.emplace_back(database, "Encoder" + std::to_string(joint),
                          std::initializer_list<std::string_view>{"Position", "Velocity"});
  }
  return messages;
}

}  // namespace

RigMessage::RigMessage(const can::Database& database, std::string_view message_name,
                       std::initializer_list<std::string_view> signals) {
  const can::Message& message = database.message(message_name);
  blank_.id = message.id;
  blank_.extended = message.extended;
  blank_.fd = message.fd;
  blank_.bit_rate_switch = message.bit_rate_switch;
  blank_.length = static_cast<std::uint8_t>(message.length);
  for (const std::string_view name : signals) {
    const can::Signal* signal = message.find(name);
    if (signal == nullptr) {
      throw std::invalid_argument(database.source + ": message " + message.name + " has no signal " +
                                  std::string(name) + ", which the rig needs");
    }
    signals_.emplace_back(message, *signal);
  }
  const can::Signal* counter = message.find("Counter");
  const can::Signal* crc = message.find("Crc");
  if (counter == nullptr || crc == nullptr) {
    return;
  }
  if (counter->length != kByteBits || crc->length != kByteBits || crc->start_bit % kByteBits != 0 ||
      crc->byte_order != can::ByteOrder::kIntel) {
    throw std::invalid_argument(database.source + ": message " + message.name +
                                ": the rig needs a Counter of 8 bits and a Crc that fills one byte");
  }
  counter_.emplace(message, *counter);
  crc_.emplace(message, *crc);
  crc_byte_ = static_cast<std::size_t>(crc->start_bit / kByteBits);
}

can::Frame RigMessage::encode(std::initializer_list<double> values) noexcept PATELLA_NONBLOCKING {
  can::Frame frame = blank_;
  auto signal = signals_.begin();
  for (const double value : values) {
    (signal++)->encode(frame, value);
  }
  if (crc_) {
    counter_->setRawBits(frame, next_counter_++);
    crc_->setRawBits(frame, can::frameCrc(frame, crc_byte_));
  }
  return frame;
}

bool RigMessage::matches(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING {
  return frame.id == blank_.id && frame.extended == blank_.extended && !frame.error && !frame.remote;
}

bool RigMessage::authentic(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (frame.length != blank_.length || !crc_ || crc_->rawBits(frame) != can::frameCrc(frame, crc_byte_)) {
    return false;
  }
  return sequence_.check(counter_->rawBits(frame)).sequence != can::Sequence::kRepeated;
}

RigMessages::RigMessages(const can::Database& database, int joints)
    : encoders_(encoderMessages(database, joints)),
      drive_status_(database, "DriveStatus", {"Torque1", "Torque2", "Enabled", "Fault"}),
      emg_(database, "Emg", {"Channel1", "Channel2", "Channel3", "Channel4"}),
      truth_(database, "Truth", {"Fu1", "Fu2"}),
      operator_(database, "Operator", {"Enable", "Reset"}),
      command_(database, "TorqueCommand", {"Torque1", "Torque2", "Enable"}) {}

can::Frame RigMessages::encoder(std::size_t joint, double position_rad,
                                double velocity_rad_s) noexcept PATELLA_NONBLOCKING {
  return encoders_[joint].encode({position_rad, velocity_rad_s});
}

can::Frame RigMessages::driveStatus(const JointVector& torque_Nm, bool enabled,
                                    DriveFault fault) noexcept PATELLA_NONBLOCKING {
  return drive_status_.encode(
      {torque_Nm(0), second(torque_Nm), enabled ? 1.0 : 0.0, static_cast<double>(fault)});
}

can::Frame RigMessages::emg(const EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING {
  return emg_.encode({signal_mV[0], signal_mV[1], signal_mV[2], signal_mV[3]});
}

can::Frame RigMessages::truth(const JointVector& f_u_rad_s2) noexcept PATELLA_NONBLOCKING {
  return truth_.encode({f_u_rad_s2(0), second(f_u_rad_s2)});
}

can::Frame RigMessages::operatorButtons(bool enable, bool reset) noexcept PATELLA_NONBLOCKING {
  return operator_.encode({enable ? 1.0 : 0.0, reset ? 1.0 : 0.0});
}

bool RigMessages::decodeCommand(const can::Frame& frame, JointVector& torque_Nm,
                                bool& enable) noexcept PATELLA_NONBLOCKING {
  if (!command_.authentic(frame)) {
    return false;
  }
  for (Eigen::Index i = 0; i < torque_Nm.size(); ++i) {
    torque_Nm(i) = command_.decode(frame, static_cast<std::size_t>(i));
  }
  enable = command_.decode(frame, 2) != 0.0;
  return true;
}

}  // namespace patella::sim
