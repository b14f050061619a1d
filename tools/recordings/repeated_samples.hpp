// Signals that a faster recorder repeats until their next sample comes.
#pragma once

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Brings a recording to the rate of its slowest position or torque, if every value of that signal stands in
/// several rows: the rows between are no samples, and would let the signal come half its period late. Each
/// repeated signal is read at the rows in which its value is new. A torque that is not repeated becomes its
/// mean until the next row. What was done is said in a warning. `recording` is in motion.
void readWhereNew(Recording& recording);

}  // namespace patella::diagnose
