# The rig is killed while torque flows and started again: a latched fault that names the cause, no torque meanwhile, and
# torque again only after the new rig's operator has reset and enabled.
# board: kernel=rt time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
start_rig vcan0
{
  sleep 1.7
  kill -KILL "$rig_pid"
  sleep 0.5
  sed -i 's/^enable_at_s.*/enable_at_s = 1.5\nreset_at_s = [0.8]/' "$config"
  patella-rig --config "$config" can:vcan0 --duration 4 >"$PATELLA_ARTEFACTS/second_rig.txt" 2>&1
} &
run_loop vcan0 5 --require-rt
kill %+ 2>/dev/null
cat "$PATELLA_ARTEFACTS/second_rig.txt"
expect "exit status of the loop" "$status" -eq 0
require final_state = active
require stops -eq 1
require overruns -eq 0
grep -q '"encoder_stale"' "$run/summary.json" || fail "summary.json does not name encoder_stale"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
         $column["state"] == 4 && ($column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0) { exit 1 }' \
  "$run/ticks.csv" || fail "torque was commanded in the fault state"
finish
