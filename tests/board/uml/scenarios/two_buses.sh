#!/bin/sh
# The loop and the rig as two processes with a drive on each of vcan0 and vcan1. First nothing is lost and torque
# flows; then one interface reports bus-off, and then goes down: the loop stops, and the other drive has no torque.
# two_buses.sh PATELLA PATELLA_RIG CONFIG
set -eu
/usr/sbin/ip link add dev vcan1 type vcan
/usr/sbin/ip link set dev vcan1 mtu 72 up
PATELLA_CAN_INTERFACE=vcan0,vcan1
. "$(dirname "$0")/with_rig.sh"
start_rig
run_loop 6
stop_rig
require receive_dropped -eq 0
require send_failed -eq 0
require error_frames -eq 0
require frames_received -ge 2000
require final_state = active
require stops -eq 0
require heap_allocations -eq 0
# Each drive's frames are on its own interface, SYNC on both.
for place in 'vcan0 201' 'vcan0 181' 'vcan0 080' 'vcan1 202' 'vcan1 182' 'vcan1 080' 'vcan1 130'; do
  grep -q " $place#" "$run/frames.log" || { echo "frames.log has no $place" >&2; failed=1; }
done
! grep -qE ' vcan0 (202|182|130)#| vcan1 (201|181)#' "$run/frames.log" || { echo "a frame on the other bus" >&2; failed=1; }

# stopped_by FAULT COMMAND...: the command is run after 7 s of torque.
stopped_by() {
  fault=$1; shift
  start_rig
  run_loop 9 &
  loop_pid=$!
  sleep 7
  "$@"
  status=0
  wait "$loop_pid" || status=$?
  stop_rig || true
  [ "$status" -eq 3 ] || { echo "$fault: the loop ended with status $status, expected 3" >&2; failed=1; }
  require final_state = fault
  grep -q 'state=active' "$run/events.log" || { echo "$fault: torque never flowed" >&2; failed=1; }
  grep -qE "raised=$fault .*bus=knee" "$run/events.log" || { cat "$run/events.log" >&2; failed=1; }
  ! grep -q 'bus=hip' "$run/events.log" || { echo "$fault: the other bus is blamed" >&2; failed=1; }
  # From the fault on, every command on the other bus is without torque: 6071h is its last two bytes.
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
           $column["state"] == 4 && ($column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0) { exit 1 }' \
    "$run/ticks.csv" || { echo "$fault: torque was commanded in the fault state" >&2; failed=1; }
  grep ' vcan0 201#' "$run/frames.log" | tail -n 50 | grep -qv '0000$' &&
    { echo "$fault: torque on vcan0 long after the fault" >&2; failed=1; }
  return 0
}
stopped_by bus_off cansend vcan1 20000040#0000000000000000
stopped_by bus_off /usr/sbin/ip link set dev vcan1 down
exit "$failed"
