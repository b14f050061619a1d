#!/bin/sh
# The loop and two drives of others, in another process, on vcan0 for eight seconds: both enter, torque flows,
# nothing is lost or refused.
# drives.sh PATELLA PATELLA_RIG CONFIG
set -eu
. "$(dirname "$0")/with_rig.sh"
start_rig
run_loop 8
stop_rig
require receive_dropped -eq 0
require send_failed -eq 0
require error_frames -eq 0
require final_state = active
require stops -eq 0
require heap_allocations -eq 0
exit "$failed"
