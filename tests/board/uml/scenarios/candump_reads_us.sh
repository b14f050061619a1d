#!/bin/sh
# can-utils understand what we put on the bus and what we write down: candump hears every torque command that the
# loop recorded, and log2asc reads the recording. candump_reads_us.sh PATELLA PATELLA_RIG CONFIG
set -eu
. "$(dirname "$0")/with_rig.sh"
start_rig
candump -L "$PATELLA_CAN_INTERFACE,080:7FF" >heard.log &
candump_pid=$!
sleep 0.3
run_loop 2
sleep 0.5
kill -INT "$candump_pid"
wait "$candump_pid" || true
stop_rig
payloads() { sed -n 's/^.* 080#\([0-9A-Fa-f]*\).*$/\1/p' "$1" | tr a-f A-F; }
payloads heard.log >heard.txt
payloads "$run/frames.log" >recorded.txt
cp heard.log "$PATELLA_ARTEFACTS/"
[ -s recorded.txt ] || { echo "frames.log holds no torque command" >&2; exit 1; }
cmp heard.txt recorded.txt || { echo "candump heard other commands than the loop recorded" >&2; exit 1; }
log2asc -I "$run/frames.log" -O frames.asc "$PATELLA_CAN_INTERFACE"
[ "$(awk '$3 == "80"' frames.asc | wc -l)" = "$(wc -l <recorded.txt)" ] || {
  echo "log2asc read another number of commands than were recorded" >&2
  exit 1
}
