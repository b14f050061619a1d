#!/usr/bin/env bash
# Wireshark's dissector of CANopen on what we sent and heard: no frame is malformed, and each is what we took it for.
#
#   check_with_tshark.sh PATELLA SOURCE_FOLDER LOG
#
# LOG is that of foreign_slave.sh, with set-up; where there is none, a run on simulated drives alone is looked at.
set -euo pipefail
patella=$1 source=$2 log=$3
if ! command -v tshark >/dev/null; then
  line=$(printf '=%.0s' {1..90})
  printf '%s\nSKIPPED, no decoder of another author read our CANopen frames: no tshark (package tshark)\n%s\n' "$line" "$line" >&2
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

decode() { tshark -r "$1" -d can.subdissector,canopen "${@:2}" 2>/dev/null; }

# expect LOG IDENTIFIER(S) WORDS: the frames of these identifiers are there, and all are called so.
expect() {
  local rows
  rows=$(decode "$1" -Y "$2" -T fields -e _ws.col.Info)
  if [ -z "$rows" ] || grep -qvE "$3" <<<"$rows"; then
    echo "FAILS  $2: expected '$3', found: $(sort -u <<<"$rows" | head -n 3 | tr '\n' ';')" && failed=1
  else
    echo "ok     $(wc -l <<<"$rows") frames '$3'"
  fi
}

# well LOG: nothing in it is malformed.
well() {
  local bad
  bad=$(decode "$1" -Y '_ws.malformed || _ws.expert.severity == "Error" || _ws.unreassembled' | wc -l)
  [ "$bad" -eq 0 ] || { echo "FAILS  $bad frames of $1 are malformed" && failed=1; }
}

"$patella" run --config "$source/firmware_app/config/two_buses.toml" --clock virtual --duration 1 --out "$folder/run" >/dev/null
grep -E ' can0 | can1 (08|18|20|58|60|70|77)' "$folder/run/frames.log" >"$folder/run.log"  # EMG and buttons are no CANopen
well "$folder/run.log"
expect "$folder/run.log" 'can.id == 0x80' '^SYNC$'
expect "$folder/run.log" 'can.id == 0x201 || can.id == 0x202' 'PDO1 \(rx\)'
expect "$folder/run.log" 'can.id == 0x181 || can.id == 0x182' 'PDO1 \(tx\)'
expect "$folder/run.log" 'can.id == 0x77f' 'NMT Error Control: Operational'
expect "$folder/run.log" 'can.id == 0x701 || can.id == 0x702' 'NMT Error Control: Operational'
expect "$folder/run.log" 'can.id == 0x601' 'SDO'
expect "$folder/run.log" 'can.id == 0' '^NMT: Enter pre-operational state'

if [ -f "$log" ]; then
  grep -vE ' pipe0 0A0#' "$log" >"$folder/set_up.log"
  well "$folder/set_up.log"
  expect "$folder/set_up.log" 'can.id == 0x601 || can.id == 0x602' 'SDO.*(Initiate|Upload|Download)'
  expect "$folder/set_up.log" 'can.id == 0x581 || can.id == 0x582' 'SDO.*(Initiate|Upload|Download|Abort)'
  expect "$folder/set_up.log" 'can.id == 0' '^NMT: (Start remote node|Enter pre-operational state)'
  expect "$folder/set_up.log" 'can.id == 0x701 || can.id == 0x702' 'NMT Error Control: (Boot-up|Pre-operational|Operational)'
else
  echo "       the set-up was not looked at: $log is missing, as foreign_slave was skipped"
fi
exit "$failed"
