# Loop and rig as two processes over vcan at 1 kHz, on a PREEMPT_RT kernel: nothing is lost, nothing overruns, and the
# loop thread neither allocates nor faults a page. vcan.sh [SECONDS]
# board: kernel=rt time=counted limit=3000
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
start_rig vcan0
run_loop vcan0 "${1:-10}" --require-rt
stop_rig
require_perfect
require ticks -eq $((${1:-10} * 1000))
require frames_received -ge $((${1:-10} * 4900))
require preempt_rt = true
require degraded = false
grep -q 'the network leaves' "$PATELLA_ARTEFACTS/loop.txt" || fail "the loop ran no network"
sha256sum "$run"/*
finish
