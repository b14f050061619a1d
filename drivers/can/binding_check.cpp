#include "drivers/can/binding_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/types.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/can/message_codec.hpp"
#include "drivers/can/named_binding.hpp"

namespace patella::can {
namespace {

/// Two scales that differ by less say the same: 0.0175 is a rounded π/180.
constexpr double kRounding = 0.005;

std::string where(const std::string& origin) {
  return origin.empty() ? "" : " (" + origin + ")";
}

void checkFree(const NamedBinding& bound, const Database& database, const Protection* protection) {
  if (protection != nullptr && bound.binding.signal == protection->counter_signal)
    bound.fail(bound.signal() + " is the counter of its message, expected one that carries data");
  if (protection != nullptr && bound.binding.signal == protection->crc_signal)
    bound.fail(bound.signal() + " is the CRC of its message, expected one that carries data");
  const Signal* signal = bound.find(database);
  if (signal != nullptr && signal->is_multiplexor)
    bound.fail(bound.signal() + " is a multiplexor, expected one that carries data");
}

void checkUnit(const NamedBinding& bound, const Database& database, Dimension dimension) {
  const Signal* signal = bound.find(database);
  const auto unit = signal == nullptr ? std::nullopt : findUnit(signal->unit);
  if (!unit || !bound.binding.scale_reason.empty())
    return;
  const std::string by_dbc = bound.signal() + " is in " + quote(signal->unit) + " by the DBC, ";
  const std::string otherwise = "; or 'scale_reason', what scale holds besides";
  if (unit->dimension != dimension) {
    const std::string_view own = unitName(dimension);
    bound.fail(by_dbc + "expected " + (own.empty() ? "no unit" : "a unit of what is " + std::string(own)) +
               " inside" + otherwise);
  }
  if (!(std::abs(std::abs(bound.binding.scale) - unit->factor) <= kRounding * unit->factor)) {
    bound.fail(by_dbc + "scale is " + digits(bound.binding.scale) + ", expected " + digits(unit->factor) +
               " or " + digits(-unit->factor) + " to have " + std::string(unitName(dimension)) + otherwise);
  }
}

class Check {
 public:
  Check(const Database& database, const BusMap& map, std::span<const CommandMap> commands)
      : database_(database), map_(map), commands_(commands) {}

  void runCommands() {
    for (const CommandMap& command : commands_)
      checkCommand(command);
  }

  void run() {
    runCommands();
    for (const Protection& protection : map_.protections)
      checkProtection(protection);
    for (const Binding& binding : map_.bindings)
      checkInput(binding);
    for (const auto& [signal, bindings] : feeds_)
      checkShared(bindings);
    for (const CommandMap& command : commands_)
      checkEntering(command);
  }

 private:
  using Names = std::pair<std::string, std::string>;  // message and signal

  void checkParts(const Protection& protection) const {
    if (!protection.counter_signal.empty() && protection.counter_signal == protection.crc_signal) {
      refuse(protection.origin, "signal " + quote(protection.crc_signal) + " of message " +
                                    quote(protection.message) +
                                    " is counter and CRC at once, expected two signals");
    }
  }

  void checkProtection(const Protection& protection) {
    const std::string message = "message " + quote(protection.message);
    if (command_messages_.contains(protection.message)) {
      refuse(protection.origin,
             message + " is the command, expected its counter and crc in [command] and no protection here");
    }
    const auto [other, first] = protections_.try_emplace(protection.message, &protection);
    if (!first) {
      refuse(protection.origin, message + " is protected twice" + where(other->second->origin) +
                                    ", expected one protection with both counter and crc");
    }
    if (protection.counter_signal.empty() && protection.crc_signal.empty())
      refuse(protection.origin, message + " is protected by nothing, expected counter, crc or both");
    checkParts(protection);
  }

  void checkInput(const Binding& binding) {
    const NamedBinding bound{binding, "input", binding.message};
    InputId id;
    try {
      id = inputOf(binding.input, kMaxJoints);
    } catch (const std::invalid_argument& error) {
      refuse(binding.origin, error.what());
    }
    const auto [other, first] = inputs_.try_emplace({id.input, id.index}, &binding);
    if (!first) {
      refuse(binding.origin, bound.name() + " is bound twice, to signal " + quote(other->second->signal) +
                                 " of message " + quote(other->second->message) +
                                 where(other->second->origin) + " already; expected one signal");
    }
    if (command_messages_.contains(binding.message)) {
      bound.fail("message " + quote(binding.message) +
                 " is the command that the loop sends, expected one that it receives");
    }
    if (fixed_messages_.contains(binding.message))
      bound.fail("message " + quote(binding.message) + " is sent by the loop, expected one that it receives");
    const auto protection = protections_.find(binding.message);
    if (!binding.good.empty() && !id.judges())
      bound.fail("has 'good', expected that of drive_enabled and drive_fault only");
    checkFree(bound, database_, protection == protections_.end() ? nullptr : protection->second);
    checkUnit(bound, database_, id.kind().dimension);
    feeds_[{binding.message, binding.signal}].push_back(&binding);
  }

  static void checkShared(const std::vector<const Binding*>& bindings) {
    const Binding& first = *bindings.front();
    for (const Binding* binding : bindings) {
      const NamedBinding bound{*binding, "input", binding->message};
      const bool shareable = inputOf(binding->input, kMaxJoints).kind().shareable;
      if (binding->shared && !shareable)
        bound.fail("says 'shared', expected that of drive_enabled, drive_fault and drive_error only");
      if (binding->shared && bindings.size() == 1)
        bound.fail("says 'shared', but no other input reads " + bound.signal());
      if (binding != &first && !(binding->shared && first.shared)) {
        bound.fail("reads " + bound.signal() + " as input " + quote(first.input) + where(first.origin) +
                   " does; expected a signal of its own" +
                   (shareable ? ", or 'shared = true' with each of them" : ""));
      }
    }
  }

  void checkCommand(const CommandMap& command) {
    if (!command_messages_.try_emplace(command.message, &command).second) {
      refuse(command.origin.empty() ? command.protection.origin : command.origin,
             "message " + quote(command.message) + " is a command twice, expected one table for it");
    }
    checkParts(command.protection);
    std::map<std::string, const Binding*> names;
    std::map<std::string, const Binding*> signals;
    for (const Binding& binding : command.bindings) {
      const NamedBinding bound{binding, "output", command.message};
      const auto unique = [&](auto& known, const std::string& key, const std::string& problem) {
        const auto [other, first] = known.try_emplace(key, &binding);
        if (!first) {
          bound.fail(problem + " as output " + quote(other->second->input) + where(other->second->origin) +
                     " is already; expected one output for one signal");
        }
      };
      unique(names, binding.input, "is bound");
      // Torque of a joint goes to one drive; enable and state may go to each.
      if (dimensionOfOutput(binding.input) != Dimension::kNone)
        unique(torques_, binding.input, "is sent");
      unique(signals, binding.signal, "is written to " + bound.signal());
      if (binding.shared)
        bound.fail("says 'shared', expected that of inputs only: the later output would overwrite");
      checkFree(bound, database_, &command.protection);
      const Signal* signal = bound.find(database_);
      if (signal != nullptr && !signal->multiplexor.empty())
        bound.fail(bound.signal() + " is multiplexed, expected one that every frame carries");
      checkUnit(bound, database_, dimensionOfOutput(binding.input));
    }
    checkConstants(command, signals);
    checkUnbound(command, signals);
    for (const auto* frames : {&command.enter, &command.leave, &command.clear}) {
      for (const FixedFrame& frame : *frames)
        checkFixed(command, frame);
    }
  }

  void checkConstants(const CommandMap& command, const std::map<std::string, const Binding*>& outputs) const {
    const Message* message = database_.find(command.message);
    std::set<std::string> known;
    for (const Constant& constant : command.constants) {
      const std::string name =
          "constant: signal " + quote(constant.signal) + " of message " + quote(command.message);
      if (!known.insert(constant.signal).second)
        refuse(constant.origin, name + " has a constant already, expected one");
      if (outputs.contains(constant.signal))
        refuse(constant.origin, name + " is an output as well, expected one of the two");
      if (constant.signal == command.protection.counter_signal ||
          constant.signal == command.protection.crc_signal)
        refuse(constant.origin, name + " is its counter or CRC, expected one that carries data");
      if (message == nullptr)
        continue;  // whoever compiles the message says so
      const Signal* signal = message->find(constant.signal);
      if (signal == nullptr)
        refuse(constant.origin, name + " does not exist");
      Frame frame = CompiledMessage(*message, {}).blank();
      const CompiledSignal compiled(*message, *signal);
      if (!compiled.inRange(constant.value) || !compiled.encode(frame, constant.value)) {
        refuse(constant.origin, name + ": value " + digits(constant.value) +
                                    ", expected one that lies in its range and in its bits, and in a frame "
                                    "that carries it always");
      }
    }
  }

  // Bits that nobody sets are zero, which may well be full torque backwards.
  void checkUnbound(const CommandMap& command, const std::map<std::string, const Binding*>& outputs) const {
    const Message* message = database_.find(command.message);
    if (message == nullptr)
      return;
    for (const Signal& signal : message->signals) {
      const auto constant =
          std::find_if(command.constants.begin(), command.constants.end(),
                       [&](const Constant& candidate) { return candidate.signal == signal.name; });
      const bool zero = signal.offset == 0.0 && signal.factor != 0.0;
      if (zero || outputs.contains(signal.name) || constant != command.constants.end() ||
          signal.name == command.protection.counter_signal || signal.name == command.protection.crc_signal)
        continue;
      refuse(command.origin, "signal " + quote(signal.name) + " of message " + quote(command.message) +
                                 " is neither an output nor a constant, and its bits at zero mean " +
                                 (signal.factor == 0.0 ? "what no factor tells"
                                                       : digits(signal.offset) +
                                                             (signal.unit.empty() ? "" : " " + signal.unit)) +
                                 "; expected an output or a constant for it");
    }
  }

  void checkFixed(const CommandMap& command, const FixedFrame& frame) {
    const std::string& name = frame.message.empty() ? command.message : frame.message;
    fixed_messages_.insert(name);
    const Message* message = database_.find(name);
    if (message == nullptr)
      refuse(frame.origin, "message " + quote(name) + " is not in " + quote(database_.source));
    if (static_cast<int>(frame.data.size()) != message->length) {
      refuse(frame.origin, "data of " + std::to_string(frame.data.size()) + " bytes, expected " +
                               std::to_string(message->length) + " as message " + quote(name) + " has");
    }
    if (message->fd || message->length > 8)
      refuse(frame.origin, "message " + quote(name) + " is one of CAN FD, expected a classic frame");
  }

  // Who enters has to leave, and to be known to be in.
  void checkEntering(const CommandMap& command) const {
    if (command.enter.empty() != command.leave.empty()) {
      refuse(command.origin,
             std::string("command ") + quote(command.message) + " has " +
                 (command.enter.empty() ? "'leave' without 'enter'" : "'enter' without 'leave'") +
                 ", expected both or none");
    }
    if (command.enter.empty()) {
      if (command.enter_time_s != 0.0 || !command.clear.empty()) {
        refuse(command.origin, "command " + quote(command.message) + " has " +
                                   (command.clear.empty() ? "'enter_time_s'" : "'clear'") +
                                   " without 'enter', expected 'enter' and 'leave' as well");
      }
      return;
    }
    for (const Binding& binding : command.bindings) {
      const std::optional<std::size_t> index = torqueJoint(binding.input);
      if (!index)
        continue;  // whoever compiles the command says so
      const std::size_t joint = *index;
      const bool reports =
          inputs_.contains({Input::kDriveEnabled, 0}) || inputs_.contains({Input::kJointEnabled, joint});
      const std::string report = "'drive_enabled." + std::to_string(joint + 1) + "'";
      if (!reports && command.enter_time_s == 0.0) {
        refuse(command.origin, "command " + quote(command.message) +
                                   " has 'enter', but nothing is bound to " + report +
                                   " to tell when it is done; expected that, or 'enter_time_s' for a "
                                   "drive that does not report it");
      }
      if (reports && command.enter_time_s != 0.0) {
        refuse(command.origin, "command " + quote(command.message) +
                                   " has 'enter_time_s', which is for a drive "
                                   "that does not report, but " +
                                   report + " is bound");
      }
    }
  }

  const Database& database_;
  const BusMap& map_;
  std::span<const CommandMap> commands_;
  std::map<std::string, const CommandMap*> command_messages_;
  std::map<std::string, const Binding*> torques_;
  std::set<std::string> fixed_messages_;
  std::map<std::string, const Protection*> protections_;
  std::map<std::pair<Input, std::size_t>, const Binding*> inputs_;
  std::map<Names, std::vector<const Binding*>> feeds_;
};

}  // namespace

void checkBindings(const Database& database, const BusMap& map, std::span<const CommandMap> commands) {
  Check(database, map, commands).run();
}

void checkCommands(const Database& database, std::span<const CommandMap> commands) {
  const BusMap no_inputs;
  Check(database, no_inputs, commands).runCommands();
}

}  // namespace patella::can
