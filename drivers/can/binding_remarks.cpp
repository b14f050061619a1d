#include "drivers/can/binding_remarks.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/types.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/can/named_binding.hpp"

namespace patella::can {
namespace {

std::string unguarded(const Protection& protection) {
  const bool counter = !protection.counter_signal.empty();
  const bool crc = !protection.crc_signal.empty();
  if (counter && crc)
    return "";
  if (counter)
    return "has no CRC: damaged frames would be taken for good ones";
  if (crc)
    return "has no counter: frames that are lost, repeated or stale would go unseen";
  return "has neither counter nor CRC: frames that are damaged, lost or repeated would go unseen";
}

std::string unitRemark(const NamedBinding& bound, const Database& database, Dimension dimension) {
  const Signal* signal = bound.find(database);
  if (signal == nullptr)
    return "";
  const std::string scale = "scale " + digits(bound.binding.scale);
  if (!bound.binding.scale_reason.empty()) {
    const std::string unit = signal->unit.empty() ? "without a unit" : quote(signal->unit);
    return bound.name() + ": " + scale + " of " + bound.signal() + " (" + unit +
           ") stands as given: " + bound.binding.scale_reason;
  }
  if (dimension == Dimension::kNone || findUnit(signal->unit))
    return "";
  const std::string unit =
      signal->unit.empty() ? "has no unit" : "has the unknown unit " + quote(signal->unit);
  return bound.name() + ": " + bound.signal() + " " + unit + " in the DBC, so nothing tells whether " +
         scale + " makes it " + std::string(unitName(dimension));
}

class Remarks {
 public:
  void add(std::string text) {
    if (!text.empty() && std::find(texts.begin(), texts.end(), text) == texts.end())
      texts.push_back(std::move(text));
  }

  void missingInputs(const BusMap& map) {
    constexpr std::array<std::pair<Input, const char*>, 6> kWanted = {
        {{Input::kVelocity,
          "encoder_inconsistent cannot be found; a frozen or drifting encoder shows as following_error only"},
         {Input::kDriveTorque, "a drive that does not follow, or exceeds the limit, goes unseen"},
         {Input::kDriveEnabled, "a drive that stays enabled against the command goes unseen"},
         {Input::kDriveFault, "a drive's own faults stop nothing"},
         {Input::kOperatorEnable, "torque never flows"},
         {Input::kOperatorReset, "no stop is left again"}}};
    for (const auto& [input, consequence] : kWanted) {
      const auto is = [wanted = input](const Binding& binding) {
        const InputId id = inputOf(binding.input, kMaxJoints);
        return id.input == wanted || id.kind().name == kInputKinds[static_cast<std::size_t>(wanted)].name;
      };
      if (std::none_of(map.bindings.begin(), map.bindings.end(), is)) {
        add("no signal is bound to " + std::string(kInputKinds[static_cast<std::size_t>(input)].name) + ": " +
            consequence);
      }
    }
  }

  void missingProtection(const BusMap& map, bool emg_assists) {
    for (const Binding& binding : map.bindings) {
      const InputGroup group = inputOf(binding.input, kMaxJoints).kind().group;
      if (group == kNoTimeout || (group == kEmgGroup && !emg_assists))
        continue;
      const auto found =
          std::find_if(map.protections.begin(), map.protections.end(),
                       [&](const Protection& protection) { return protection.message == binding.message; });
      addUnguarded(binding.message, found == map.protections.end() ? Protection{} : *found);
    }
    for (const Protection& protection : map.protections) {
      const auto reads = [&](const Binding& binding) { return binding.message == protection.message; };
      if (std::none_of(map.bindings.begin(), map.bindings.end(), reads))
        add("message " + quote(protection.message) + " is protected, but no input reads it");
    }
  }

  /// A bus on which nobody counts or checks, as that of most drives.
  void nothingGuarded(const BusMap& map, std::span<const CommandMap> commands) {
    const auto none = [](const Protection& protection) {
      return protection.counter_signal.empty() && protection.crc_signal.empty();
    };
    const bool commands_too = std::all_of(commands.begin(), commands.end(),
                                          [&](const CommandMap& c) { return none(c.protection); });
    const auto drive = [](const Binding& binding) {
      const InputGroup group = inputOf(binding.input, kMaxJoints).kind().group;
      return group == kEncoderGroup || group == kDriveGroup;
    };
    const auto guarded = [&](const Binding& binding) {
      return std::any_of(map.protections.begin(), map.protections.end(), [&](const Protection& protection) {
        return protection.message == binding.message && !none(protection);
      });
    };
    if (commands_too && std::none_of(map.bindings.begin(), map.bindings.end(),
                                     [&](const Binding& b) { return drive(b) && guarded(b); })) {
      add("no message of encoders, drives and command has a counter or a CRC: frame_corrupt and "
          "frame_sequence cannot be found; docs/safety.md says what stands in");
    }
  }

  void addUnguarded(const std::string& message, const Protection& protection) {
    if (const std::string text = unguarded(protection); !text.empty())
      add("message " + quote(message) + " " + text);
  }

  std::vector<std::string> texts;
};

}  // namespace

std::vector<std::string> bindingRemarks(const Database& database, const BusMap& map,
                                        std::span<const CommandMap> commands, bool emg_assists) {
  Remarks remarks;
  remarks.missingInputs(map);
  remarks.missingProtection(map, emg_assists);
  remarks.nothingGuarded(map, commands);
  for (const Binding& binding : map.bindings) {
    const Dimension dimension = inputOf(binding.input, kMaxJoints).kind().dimension;
    remarks.add(unitRemark({binding, "input", binding.message}, database, dimension));
  }
  for (const CommandMap& command : commands) {
    remarks.addUnguarded(command.message, command.protection);
    for (const Binding& binding : command.bindings) {
      const Dimension dimension = dimensionOfOutput(binding.input);
      remarks.add(unitRemark({binding, "output", command.message}, database, dimension));
    }
  }
  return std::move(remarks.texts);
}

}  // namespace patella::can
