// Where and how urgently the kernel serves interrupts, as far as it concerns the loop. Looks only; changes
// nothing.
#pragma once

#include <vector>

#include "firmware_app/realtime/finding.hpp"
#include "firmware_app/realtime/host_files.hpp"
#include "firmware_app/realtime/host_readiness.hpp"

namespace patella::app {

/// `irq_affinity`: interrupts that may run on the loop's processors. `can_irq_priority`, where the CAN
/// interface has an interrupt thread (PREEMPT_RT): it must come before the loop, or frames that arrive during
/// a tick wait in the controller, which on an SJA1000 holds five. Both are advice.
std::vector<Finding> interruptFindings(const HostNeeds& needs, const HostFiles& host);

}  // namespace patella::app
