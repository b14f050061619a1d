# What a tick with network, sampler, Kalman observer and five effects costs on this processor, by stage: instructions in
# user space, then time, the kernel's part included, at 1 kHz over vcan. tick.sh [SECONDS [growth]]
# board: kernel=rt time=counted limit=900 program=tools/bench/tick/patella-bench-tick
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
seconds=${1:-1.5}
only=--whole
[ "${2:-}" != growth ] || only=
make_vcan
make_config </dev/null

# bench NAME OPTION...: what patella-bench-tick prints, also in the artefact NAME.txt.
bench() {
  name=$1
  shift
  status=0
  patella-bench-tick --config "$config" --seconds "$seconds" "$@" >"$PATELLA_ARTEFACTS/$name.txt" 2>&1 || status=$?
  cat "$PATELLA_ARTEFACTS/$name.txt"
  expect "exit status of patella-bench-tick" "$status" -eq 0
}

bench instructions --count instructions $only
start_rig vcan0
bench time --real-time --can vcan0 --whole
stop_rig
# within NAME FIELD LIMIT UNIT: of the line of the whole tick.
within() {
  awk -v field="$2" -v limit="$3" -v unit="$4" '
    /^ *whole tick/ { found = 1; if ($field > limit) { print "FAILED: a tick takes " $field " " unit ", expected at most " limit; exit 1 } }
    END { if (!found) { print "FAILED: no figure for the whole tick"; exit 1 } }' "$PATELLA_ARTEFACTS/$1.txt" || failed=1
}
# Budgets, a tenth above what was counted when this was written: mean, and p99.9. The rig looks at its bus four times a
# period, on a clock of its own: whether one of these wake-ups, 13 µs and more, falls into the tick is a matter of phase.
within instructions 3 155000 instructions
within time 8 245 µs
finish
