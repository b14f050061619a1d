# --require-rt on a kernel without PREEMPT_RT: refused with the reason, and nothing is recorded; without it the run is
# marked degraded. `patella check` names the same.
# board: kernel=plain time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
start_rig vcan0
run_loop vcan0 0.5 --require-rt
expect "exit status with --require-rt" "$status" -eq 1
grep -q 'preempt_rt: no PREEMPT_RT, expected a PREEMPT_RT kernel' "$PATELLA_ARTEFACTS/loop.txt" ||
  fail "the refusal does not name preempt_rt"
[ ! -e "$run/ticks.csv" ] || fail "a refused run left a recording"
run_loop vcan0 0.5
expect "exit status without --require-rt" "$status" -eq 0
require degraded = true
require preempt_rt = false
status=0
patella check --config "$config" --backend can:vcan0 --require-rt >"$PATELLA_ARTEFACTS/check.txt" || status=$?
cat "$PATELLA_ARTEFACTS/check.txt"
expect "exit status of check --require-rt" "$status" -eq 1
grep -q 'MISSING *preempt_rt' "$PATELLA_ARTEFACTS/check.txt" || fail "check does not name preempt_rt as missing"
finish
