#include "drivers/canopen/drive_binding.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/safety/cia402_state.hpp"
#include "drivers/canopen/hexadecimal.hpp"

namespace patella::canopen {
namespace {

/// Where the mapping puts an object into its PDO.
struct Field {
  const char* object;
  int start_bit;
  int bits;
  bool is_signed;
};

constexpr Field kControlword{"6040h", 0, 16, false};
constexpr Field kTargetTorque{"6071h", 16, 16, true};
constexpr Field kStatusWord{"6041h", 0, 16, false};
constexpr Field kActualTorque{"6077h", 16, 16, true};
constexpr Field kActualPosition{"6064h", 32, 32, true};

class DriveBinding {
 public:
  DriveBinding(const DriveSettings& drive, const can::Database& database)
      : drive_(drive), database_(database) {}

  const can::Message& message(std::uint32_t id, int length, const char* what) const {
    const can::Message* found = database_.find(id, false);
    if (found == nullptr || found->length != length || found->fd) {
      fail(std::string(found == nullptr ? "no message"
                                        : "no classic message of " + std::to_string(length) + " bytes") +
           " with the identifier " + hexadecimal(id, 3) + " in '" + database_.source + "', expected the " +
           what + " of node " + std::to_string(drive_.node));
    }
    return *found;
  }

  const std::string& signal(const can::Message& message, const Field& field) const {
    const auto found =
        std::find_if(message.signals.begin(), message.signals.end(), [&field](const can::Signal& candidate) {
          return candidate.start_bit == field.start_bit && candidate.length == field.bits &&
                 candidate.is_signed == field.is_signed && candidate.byte_order == can::ByteOrder::kIntel &&
                 candidate.type == can::ValueType::kInteger && candidate.factor == 1.0 &&
                 candidate.offset == 0.0 && candidate.multiplexor.empty() && !candidate.is_multiplexor;
        });
    if (found == message.signals.end()) {
      fail("message '" + message.name + "' has no signal " + std::to_string(field.start_bit) + "|" +
           std::to_string(field.bits) + "@1" + (field.is_signed ? "-" : "+") + " (1,0), expected one for " +
           field.object);
    }
    return found->name;
  }

  can::Binding input(const char* name, const can::Message& message, const Field& field) const {
    can::Binding binding;
    binding.input = std::string(name) + "." + std::to_string(drive_.joint + 1);
    binding.message = message.name;
    binding.signal = signal(message, field);
    binding.origin = drive_.origin;
    return binding;
  }

  double torqueScale() const noexcept {
    constexpr double kPerMille = 1e-3;
    return kPerMille * drive_.direction * drive_.gear * drive_.rated_torque_Nm;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw std::invalid_argument((drive_.origin.empty() ? "" : drive_.origin + ": ") + problem);
  }

 private:
  const DriveSettings& drive_;
  const can::Database& database_;
};

void bindReport(const DriveSettings& drive, const DriveBinding& binding, const can::Message& report,
                can::BusMap& map) {
  can::Binding position = binding.input("position_rad", report, kActualPosition);
  position.scale = drive.direction * 2.0 * std::numbers::pi / (drive.gear * drive.counts_per_turn);
  position.offset = drive.zero_angle_rad;
  position.scale_reason = "counts of a motor behind its gear";
  can::Binding torque = binding.input("drive_torque_Nm", report, kActualTorque);
  torque.scale = binding.torqueScale();
  torque.scale_reason = "per mille of the motor's rated torque, behind its gear";
  can::Binding enabled = binding.input("drive_enabled", report, kStatusWord);
  enabled.mask = safety::kCia402EnabledMask;
  enabled.good = {safety::kCia402EnabledValue};
  enabled.shared = true;
  can::Binding fault = binding.input("drive_fault", report, kStatusWord);
  fault.mask = safety::kCia402FaultMask;
  fault.good = {0.0};
  fault.shared = true;
  map.bindings.insert(map.bindings.end(), {position, torque, enabled, fault});
}

}  // namespace

void bindDrives(const CanopenMap& canopen, const can::Database& database, can::BusMap& map,
                std::vector<can::CommandMap>& commands) {
  for (const DriveSettings& drive : canopen.drives) {
    const DriveBinding binding(drive, database);
    constexpr int kCommandBytes = 4;
    constexpr int kReportBytes = 8;
    bindReport(drive, binding, binding.message(reportId(drive.node), kReportBytes, "TPDO1"), map);
    const can::Message& message = binding.message(commandId(drive.node), kCommandBytes, "RPDO1");
    can::CommandMap command;
    command.message = message.name;
    command.origin = drive.origin;
    command.node = drive.node;
    command.controlword = binding.signal(message, kControlword);
    command.enter_timeout_s = drive.enter_timeout_s;
    can::Binding torque;
    torque.input = "torque_Nm." + std::to_string(drive.joint + 1);
    torque.signal = binding.signal(message, kTargetTorque);
    torque.scale = binding.torqueScale();
    torque.scale_reason = "per mille of the motor's rated torque, behind its gear";
    torque.origin = drive.origin;
    command.bindings.push_back(torque);
    commands.push_back(command);
  }
}

}  // namespace patella::canopen
