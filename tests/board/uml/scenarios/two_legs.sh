#!/bin/sh
# The loop of two legs and their rig as two processes, the left leg's drives on vcan0, the right leg's on vcan1:
# nothing is lost and torque flows.
# two_legs.sh PATELLA PATELLA_RIG CONFIG
set -eu
/usr/sbin/ip link add dev vcan1 type vcan
/usr/sbin/ip link set dev vcan1 mtu 72 up
PATELLA_CAN_INTERFACE=vcan0,vcan1
. "$(dirname "$0")/with_rig.sh"
start_rig
sleep 3  # the rig of four joints is to have caught up with its clock
run_loop 14
stop_rig
require receive_dropped -eq 0
require send_failed -eq 0
require error_frames -eq 0
require frames_received -ge 6000
require final_state = active
require stops -eq 0
require heap_allocations -eq 0
# Each drive's frames are on its leg's interface, SYNC on both.
for place in 'vcan0 201' 'vcan0 202' 'vcan0 181' 'vcan0 182' 'vcan0 080' \
  'vcan1 203' 'vcan1 204' 'vcan1 183' 'vcan1 184' 'vcan1 080' 'vcan1 130'; do
  grep -q " $place#" "$run/frames.log" || { echo "frames.log has no $place" >&2; failed=1; }
done
! grep -qE ' vcan0 (203|204|183|184|130)#| vcan1 (201|202|181|182)#' "$run/frames.log" ||
  { echo "a frame on the other leg's bus" >&2; failed=1; }
exit "$failed"
