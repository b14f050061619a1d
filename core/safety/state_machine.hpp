// When torque may flow. The table below is the whole behaviour: the code reads it, nothing else decides.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/safety/fault.hpp"
#include "core/types.hpp"

namespace patella::safety {

/// The numbers are those of the command frame (patella.dbc).
enum class State : std::uint8_t {
  kInit = 0,     ///< inputs not yet, or no longer, complete
  kReady = 1,    ///< healthy, no torque
  kActive = 2,   ///< torque flows
  kLimited = 3,  ///< latched: a limit of speed, range or torque was exceeded
  kFault = 4     ///< latched: anything else
};

inline constexpr int kStateCount = 5;

/// snake_case name for logs and summaries.
std::string_view stateName(State state) noexcept;

/// Faults of the movement, with all of the machinery in order.
inline constexpr FaultSet kLimitFaults{Fault::kVelocityLimit, Fault::kJointRange, Fault::kTorqueLimit};
/// Faults that latch even before the inputs were complete; the others are how sensors and drives boot.
inline constexpr FaultSet kUrgentFaults{Fault::kEmergencyStop, Fault::kBusOff};

enum class Condition : std::uint8_t {
  kUrgentFault = 0,  ///< one of kUrgentFaults
  kStopFault,        ///< any fault but kLimitFaults
  kLimitFault,       ///< one of kLimitFaults
  kInputsLost,       ///< inputs not valid, without a fault
  kInputsHealthy,    ///< inputs valid and no fault for N ticks in a row
  kEnableRaised,     ///< rising edge of enable
  kEnableReleased,   ///< enable is low
  kResetRaised       ///< rising edge of reset while kInputsHealthy holds; an earlier edge is lost
};

struct Transition {
  State from;
  Condition when;
  State to;
};

/// Rows of a state are tried from the top, the first that holds is taken, one a tick; none: the state stays.
inline constexpr std::array kTransitions = {
    Transition{State::kInit, Condition::kUrgentFault, State::kFault},
    Transition{State::kInit, Condition::kInputsHealthy, State::kReady},

    Transition{State::kReady, Condition::kStopFault, State::kFault},
    Transition{State::kReady, Condition::kLimitFault, State::kLimited},
    Transition{State::kReady, Condition::kInputsLost, State::kInit},
    Transition{State::kReady, Condition::kEnableRaised, State::kActive},

    Transition{State::kActive, Condition::kStopFault, State::kFault},
    Transition{State::kActive, Condition::kLimitFault, State::kLimited},
    Transition{State::kActive, Condition::kInputsLost, State::kInit},
    Transition{State::kActive, Condition::kEnableReleased, State::kReady},

    Transition{State::kLimited, Condition::kStopFault, State::kFault},
    Transition{State::kLimited, Condition::kResetRaised, State::kReady},

    Transition{State::kFault, Condition::kResetRaised, State::kReady},
};

struct StateInputs {
  FaultSet faults{};          ///< all of this tick
  bool inputs_valid = false;  ///< every bound input has come and is fresh
  bool enable = false;        ///< level
  bool reset = false;         ///< level
};

struct StateOutput {
  State state = State::kInit;
  bool torque_allowed = false;        ///< active, thus without a fault in this very tick
  bool entered_active = false;        ///< in this tick: re-seed observers, filters, network, reference
  bool entered_stop = false;          ///< in this tick: torque was allowed in the one before
  FaultSet latched{};                 ///< all since torque was stopped, until reset
  Fault first_cause = Fault::kCount;  ///< what stopped it: lowest number of the first tick; kCount for none
};

class StateMachine {
 public:
  /// Inputs must be healthy for that many ticks in a row. Throws std::invalid_argument outside the bounds of
  /// safety.healthy_ticks.
  explicit StateMachine(int healthy_ticks = 50);

  /// One tick. Enable and reset that are held since before the first tick are no edges.
  StateOutput step(const StateInputs& inputs) noexcept PATELLA_NONBLOCKING;

 private:
  int healthy_ticks_;
  int healthy_count_ = 0;
  State state_ = State::kInit;
  bool enable_before_ = true;
  bool reset_before_ = true;
  FaultSet latched_;
  Fault first_cause_ = Fault::kCount;
};

}  // namespace patella::safety
