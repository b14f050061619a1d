#!/usr/bin/env bash
# Does anything grow or drift? Runs the loop for a long time and watches its process from outside.
#
#   tools/bench/soak.sh virtual HOURS [BUILD]     against the in-process rig, as fast as the machine allows
#   tools/bench/soak.sh wall MINUTES [BUILD]      in wall time, with the shipped configuration
#
# Prints resident memory and open files over the run, dropped records, and missed periods: ticks are anchored once, so ticks
# and missed periods together are the time that passed, and a drift would show as a missed period. Needs some 3.3 GB of
# disk an hour (TMPDIR). Exit status: 0 nothing found, 1 could not run, 2 memory or files grew, or records were dropped although
# the disk kept up.
set -euo pipefail
cd "$(dirname "$0")/../.."
usage() { sed -n '2,10s/^# \{0,1\}//p' "$0" >&2; exit 1; }
[ $# -ge 2 ] || usage
kind=$1 length=$2 build=${3:-build/release}
[[ $length =~ ^[0-9]+([.][0-9]+)?$ ]] || usage
case $kind in
  virtual) seconds=$(awk "BEGIN { print $length * 3600 }"); clock=virtual ;;
  wall) seconds=$(awk "BEGIN { print $length * 60 }"); clock=monotonic ;;
  *) usage ;;
esac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# An hour at 1 kHz is some 3.3 GB of recording; it goes with the folder.
"$build"/firmware_app/patella run --config firmware_app/config/adult.toml --clock "$clock" --duration "$seconds" \
  --out "$folder/run" >"$folder/text" 2>&1 &
process=$!
started=$(date +%s.%N)
printf '%10s %12s %8s\n' "wall, s" "memory, KB" "files"
first_kb=0 last_kb=0 first_files=0 last_files=0 samples=0
pause=2
while kill -0 "$process" 2>/dev/null; do
  sleep "$pause"
  memory=$(awk '/^VmRSS/ { print $2 }' "/proc/$process/status" 2>/dev/null || true)
  [ -n "$memory" ] || break
  files=$(find "/proc/$process/fd" -mindepth 1 2>/dev/null | wc -l)
  [ "$files" -gt 0 ] || break
  samples=$((samples + 1))
  # What is there after the first samples is set-up.
  if [ "$samples" -le 3 ]; then first_kb=$memory first_files=$files; fi
  last_kb=$memory last_files=$files
  printf '%10.0f %12d %8d\n' "$(awk "BEGIN { print $(date +%s.%N) - $started }")" "$memory" "$files"
  [ $((samples % 10)) -ne 0 ] || pause=$((pause < 60 ? pause * 2 : 60))
done
status=0
wait "$process" || status=$?
wall=$(awk "BEGIN { print $(date +%s.%N) - $started }")
cat "$folder/text"
[ "$status" -ne 1 ] || exit 1
summary=$folder/run/summary.json
number() { grep -oE "\"$1\": [0-9]+" "$summary" | head -1 | grep -oE '[0-9]+$'; }
echo
echo "wall time $wall s for $seconds s of the loop; memory $first_kb KB after set-up, $last_kb KB at the end; files $first_files and $last_files"
echo "dropped: $(number ticks_dropped) ticks, $(number frames_dropped) frames; missed periods $(number missed_periods) of $(number ticks) ticks"
found=0
[ "$last_kb" -le $((first_kb + first_kb / 50 + 512)) ] || { echo "memory grew" >&2; found=2; }
[ "$last_files" -le "$first_files" ] || { echo "open files grew" >&2; found=2; }
[ "$(number ticks_dropped)" -eq 0 ] && [ "$(number frames_dropped)" -eq 0 ] || { echo "records were dropped" >&2; found=2; }
exit $found
