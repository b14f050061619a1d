// A paper leg on a bus, and a controller's pen to write commands with.
#pragma once

#include <filesystem>
#include <numbers>
#include <vector>

#include "core/model/presets.hpp"
#include "drivers/can/dbc.hpp"
#include "sim/rig.hpp"
#include "sim/rig_messages.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::sim {

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;

inline const can::Database& rigDatabase() {
  static const can::Database database = can::loadDbc(checkout::source() / "drivers/can/patella.dbc");
  return database;
}

inline RigOptions paperRig() {
  RigOptions options;
  options.mechanism = model::paperLeg().parameters;
  for (int joint = 0; joint < 2; ++joint) {
    options.known_effects.push_back({"viscous_friction", joint, {model::paperLeg().viscous_Nms_rad}});
  }
  options.interaction = {.kind = InteractionKind::kExperiment1, .form = InteractionForm::kAsPrinted};
  options.emg = scheduledEmg();
  options.initial_q_rad = {-std::numbers::pi / 2.0, 0.0};
  return options;
}

/// Writes commands as the loop does.
class CommandPen {
 public:
  can::Frame write(double first_Nm, double second_Nm, bool enable = true) {
    return message_.make({first_Nm, second_Nm, enable ? 1.0 : 0.0});
  }

 private:
  OutgoingMessage message_{rigDatabase(), "TorqueCommand", {"Torque1", "Torque2", "Enable"}};
};

inline std::vector<can::Frame> drain(Rig& rig) {
  std::vector<can::Frame> frames;
  can::Frame frame;
  while (rig.pop(frame)) {
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace patella::sim
