# The interface goes down while torque flows and comes up again: a latched fault, then frames again without a restart of
# either program, and ready after the operator's reset.
# board: kernel=rt time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
sed -i 's/^enable_at_s.*/&\nreset_at_s = [3.0, 3.4]/' "$config"
start_rig vcan0
{
  sleep 1.7
  ip link set vcan0 down
  sleep 0.2
  ip link set vcan0 up
} &
run_loop vcan0 4 --require-rt
wait $!
stop_rig
expect "exit status of the loop" "$status" -eq 0
require final_state = ready
require stops -eq 1
require ticks -eq 4000
require overruns -eq 0
grep -q '"bus_off"' "$run/summary.json" || fail "summary.json does not name bus_off"
# Commands refused while it was down; afterwards they were accepted again.
require send_failed -ge 190
require send_failed -le 250
require frames_sent -ge 3750
finish
