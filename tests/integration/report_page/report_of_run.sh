#!/usr/bin/env bash
# patella-report and patella-convert on a run of the loop: nothing of a recording is written over, and a table that was cut
# off is drawn up to there.
#
#   report_of_run.sh PATELLA PATELLA_REPORT PATELLA_CONVERT CONFIG DBC
set -euo pipefail
patella=$1 report=$2 convert=$3 config=$4 dbc=$5
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "report_of_run.sh: $*" >&2; exit 1; }

run=$folder/run
"$patella" run --config "$config" --clock virtual --duration 1 --out "$run" >/dev/null
sums=$(cd "$run" && sha256sum ./*)
refused() { # WORDS PROGRAM...
  if "${@:2}" >"$folder/said.txt" 2>&1; then fail "taken: ${*:2}"; fi
  grep -qF -- "$1" "$folder/said.txt" || fail "no '$1': $(cat "$folder/said.txt")"
}
refused "--out: value '$run/ticks.csv', which is read from" "$report" "$run" --out "$run/ticks.csv"
refused "--png: value '$run/summary.json', which is read from" "$report" "$run" --png "$run/summary.json"
refused "--png: value '$folder/x', which is the page's" "$report" "$run" --out "$folder/x" --png "$folder/x"
refused "--out: value '$run/frames.log', which is read from" "$convert" --mcap "$run" --out "$run/frames.log"
refused "--out: value '$run/frames.log', which is read from" \
  "$convert" --decode "$run/frames.log" --dbc "$dbc" --out "$run/frames.log"
[ "$(cd "$run" && sha256sum ./*)" = "$sums" ] || fail "a recording was changed"

head -c -20 "$run/ticks.csv" >"$folder/ticks.csv"
cp "$folder/ticks.csv" "$run/ticks.csv"
"$report" "$run" >"$folder/said.txt" 2>&1 || fail "a table that was cut off is refused: $(cat "$folder/said.txt")"
grep -qF "ticks.csv:1001: the table ends within this line" "$folder/said.txt" || fail "not told: $(cat "$folder/said.txt")"
grep -q '999 ticks' "$folder/said.txt" || fail "$(cat "$folder/said.txt")"
