#!/bin/sh
# The loop and the rig as two processes on vcan0 for six seconds: torque flows, nothing is lost, nothing refused.
# loop_and_rig.sh PATELLA PATELLA_RIG CONFIG
set -eu
. "$(dirname "$0")/with_rig.sh"
start_rig
run_loop 6
stop_rig
require receive_dropped -eq 0
require send_failed -eq 0
require error_frames -eq 0
require bus_off -eq 0
require frames_received -ge 4500
require corrupt -eq 0
require final_state = active
require stops -eq 0
require heap_allocations -eq 0
exit "$failed"
