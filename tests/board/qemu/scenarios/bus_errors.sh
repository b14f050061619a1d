# Error frames as a controller reports them: error-passive is counted and torque goes on, bus-off stops it.
# board: kernel=rt time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
start_rig vcan0
{
  sleep 1.7
  cansend vcan0 20000004#0010000000000000
  cansend vcan0 20000004#0020000000000000
  cansend vcan0 20000002#0000000000000000
  sleep 0.5
  cansend vcan0 20000040#0000000000000000
} &
run_loop vcan0 3 --require-rt
wait $!
stop_rig
expect "exit status of the loop" "$status" -eq 3
require error_passive -eq 2
require bus_off -eq 1
# Lost arbitration (the third frame) is filtered in the kernel.
require error_frames -eq 3
require final_state = fault
require stops -eq 1
grep -q 'state=fault raised=bus_off$' "$run/events.log" || fail "events.log does not name bus_off alone as the cause"
# Torque flowed for half a second after the error-passive reports.
expect "ticks with torque" "$(sed -n 's/^ *"active": \([0-9]*\),*$/\1/p' "$run/summary.json")" -ge 900
finish
