#include "core/safety/state_machine.hpp"

#include <algorithm>

#include "core/bounds/bounds.hpp"

namespace patella::safety {
namespace {

/// The conditions that hold in one tick.
class ConditionSet {
 public:
  void set(Condition condition, bool holds) noexcept { bits_ |= holds ? mask(condition) : 0U; }
  bool has(Condition condition) const noexcept { return (bits_ & mask(condition)) != 0; }

 private:
  static unsigned mask(Condition condition) noexcept { return 1U << static_cast<unsigned>(condition); }
  unsigned bits_ = 0;
};

State next(State state, ConditionSet conditions) noexcept {
  for (const Transition& row : kTransitions) {
    if (row.from == state && conditions.has(row.when)) {
      return row.to;
    }
  }
  return state;
}

constexpr bool isLatched(State state) noexcept {
  return state == State::kLimited || state == State::kFault;
}

}  // namespace

std::string_view stateName(State state) noexcept {
  static constexpr std::array<std::string_view, kStateCount> kNames = {"init", "ready", "active", "limited",
                                                                       "fault"};
  const auto index = static_cast<std::size_t>(state);
  return index < kNames.size() ? kNames[index] : "unknown";
}

StateMachine::StateMachine(int healthy_ticks) : healthy_ticks_(healthy_ticks) {
  requireBound(boundOf("safety.healthy_ticks"), healthy_ticks);
}

StateOutput StateMachine::step(const StateInputs& inputs) noexcept PATELLA_NONBLOCKING {
  const bool healthy = inputs.inputs_valid && !inputs.faults.any();
  healthy_count_ = healthy ? std::min(healthy_count_ + 1, healthy_ticks_) : 0;
  const bool long_healthy = healthy_count_ == healthy_ticks_;

  ConditionSet conditions;
  conditions.set(Condition::kUrgentFault, (inputs.faults & kUrgentFaults).any());
  conditions.set(Condition::kStopFault, inputs.faults.without(kLimitFaults).any());
  conditions.set(Condition::kLimitFault, (inputs.faults & kLimitFaults).any());
  conditions.set(Condition::kInputsLost, !inputs.inputs_valid);
  conditions.set(Condition::kInputsHealthy, long_healthy);
  conditions.set(Condition::kEnableRaised, inputs.enable && !enable_before_);
  conditions.set(Condition::kEnableReleased, !inputs.enable);
  conditions.set(Condition::kResetRaised, inputs.reset && !reset_before_ && long_healthy);

  const State before = state_;
  state_ = next(before, conditions);
  if (!isLatched(state_)) {
    latched_ = {};
    first_cause_ = Fault::kCount;
  } else {
    latched_ = latched_ | inputs.faults;
    if (!isLatched(before)) {
      first_cause_ = inputs.faults.first();
    }
  }
  enable_before_ = inputs.enable;
  reset_before_ = inputs.reset;

  const bool active = state_ == State::kActive;
  const bool was_active = before == State::kActive;
  return {.state = state_,
          .torque_allowed = active,
          .entered_active = active && !was_active,
          .entered_stop = was_active && !active,
          .latched = latched_,
          .first_cause = first_cause_};
}

}  // namespace patella::safety
