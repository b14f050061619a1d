#!/bin/sh
# The rig is killed while torque flows: the loop ends in a latched fault that names the cause, and says so by its status.
# rig_dies.sh PATELLA PATELLA_RIG CONFIG
set -eu
. "$(dirname "$0")/with_rig.sh"
start_rig
run_loop 9 &
loop_pid=$!
sleep 7
kill -KILL "$rig_pid"
status=0
wait "$loop_pid" || status=$?
[ "$status" -eq 3 ] || { echo "the loop ended with status $status, expected 3" >&2; failed=1; }
require final_state = fault
require stops -eq 1
grep -q '"encoder_stale"' "$run/summary.json" || { echo "summary.json does not name encoder_stale" >&2; failed=1; }
grep -q 'state=active' "$run/events.log" || { echo "torque never flowed" >&2; failed=1; }
# From the fault on, every command is zero and disabled: state 4, no torque bits.
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
         $column["state"] == 4 && ($column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0) { exit 1 }' \
  "$run/ticks.csv" || { echo "torque was commanded in the fault state" >&2; failed=1; }
exit "$failed"
