#!/usr/bin/env bash
# Does anything grow or drift? Runs the loop for a long time and watches its process from outside.
#
#   tools/bench/soak.sh virtual HOURS [BUILD [CONFIG]]     against the in-process rig, as fast as the machine allows
#   tools/bench/soak.sh wall MINUTES [BUILD [CONFIG]]      in wall time, with the shipped configuration or another
#
# Prints resident memory and open files over the run, dropped records, and missed periods. Ticks are anchored once, so the
# stamps of the first and the last command lie as far apart as the ticks and missed periods between them: what is more is
# drift. What has been recorded is given back to the disk behind the writer's back; where the file system cannot (fallocate
# --punch-hole), an hour needs some 3.3 GB (TMPDIR). Exit status: 0 nothing found, 1 could not run, 2 memory or files grew,
# the period drifted, or records were dropped although the disk kept up.
set -euo pipefail
cd "$(dirname "$0")/../.."
usage() { sed -n '2,11s/^# \{0,1\}//p' "$0" >&2; exit 1; }
[ $# -ge 2 ] || usage
kind=$1 length=$2 build=${3:-build/release} config=${4:-firmware_app/config/adult.toml}
[[ $length =~ ^[0-9]+([.][0-9]+)?$ ]] || usage
case $kind in
  virtual) seconds=$(awk "BEGIN { print $length * 3600 }"); clock=virtual ;;
  wall) seconds=$(awk "BEGIN { print $length * 60 }"); clock=monotonic ;;
  *) usage ;;
esac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run=$folder/run
"$build"/firmware_app/patella run --config "$config" --clock "$clock" --duration "$seconds" \
  --out "$run" >"$folder/text" 2>&1 &
process=$!
started=$(date +%s.%N)

# All but the last megabytes of what has been recorded.
give_back() {
  local file size
  for file in "$run"/frames.log "$run"/ticks.csv; do
    size=$(stat -c %s "$file" 2>/dev/null || echo 0)
    [ "$size" -lt 64000000 ] || fallocate --punch-hole --offset 0 --length $((size / 4096 * 4096 - 16777216)) "$file" 2>/dev/null || true
  done
}
stamps() { grep -a ' 080#' | sed 's/^.*(\([0-9.]*\)).*/\1/'; }

printf '%10s %12s %8s\n' "wall, s" "memory, KB" "files"
first_kb=0 last_kb=0 first_files=0 last_files=0 samples=0
first_stamp=
pause=2
while kill -0 "$process" 2>/dev/null; do
  sleep "$pause"
  memory=$(awk '/^VmRSS/ { print $2 }' "/proc/$process/status" 2>/dev/null || true)
  [ -n "$memory" ] || break
  files=$(find "/proc/$process/fd" -mindepth 1 2>/dev/null | wc -l)
  [ "$files" -gt 0 ] || break
  samples=$((samples + 1))
  # Memory and files after the first samples are set-up.
  if [ "$samples" -le 3 ]; then first_kb=$memory first_files=$files; fi
  [ -n "$first_stamp" ] || first_stamp=$(head -c 20000 "$run/frames.log" | stamps | head -n 1 || true)
  last_kb=$memory last_files=$files
  printf '%10.0f %12d %8d\n' "$(awk "BEGIN { print $(date +%s.%N) - $started }")" "$memory" "$files"
  give_back
  [ $((samples % 10)) -ne 0 ] || pause=$((pause < 60 ? pause * 2 : 60))
done
status=0
wait "$process" || status=$?
wall=$(awk "BEGIN { print $(date +%s.%N) - $started }")
cat "$folder/text"
[ "$status" -ne 1 ] || exit 1
summary=$run/summary.json
number() { grep -oE "\"$1\": [0-9]+" "$summary" | head -1 | grep -oE '[0-9]+$'; }
# The frames after the last tick's tell the drives to stop.
after=$(($(number frames_sent) - $(number ticks)))
last_stamp=$(tail -c 200000 "$run/frames.log" | stamps | tail -n $((after + 1)) | head -n 1)
drift_us=$(awk -v last="$last_stamp" -v first="${first_stamp:-0}" -v periods=$(($(number ticks) - 1 + $(number missed_periods))) \
  'BEGIN { split(last, l, "."); split(first, f, "."); printf "%.0f", (l[1] - f[1]) * 1e6 + (l[2] - f[2]) - periods * 1000 }')
echo
echo "wall time $wall s for $seconds s of the loop; memory $first_kb KB after set-up, $last_kb KB at the end; files $first_files and $last_files"
echo "dropped: $(number ticks_dropped) ticks, $(number frames_dropped) frames; missed periods $(number missed_periods) of $(number ticks) ticks"
echo "the last command is $drift_us us off the first one's clock"
found=0
[ "$last_kb" -le $((first_kb + first_kb / 50 + 512)) ] || { echo "memory grew" >&2; found=2; }
[ "$last_files" -le "$first_files" ] || { echo "open files grew" >&2; found=2; }
[ "$(number ticks_dropped)" -eq 0 ] && [ "$(number frames_dropped)" -eq 0 ] || { echo "records were dropped" >&2; found=2; }
# A tick is late by its wake-up and by the clock's own slewing, not by more the longer it lasts.
[ "${drift_us#-}" -lt 20000 ] || { echo "the period drifted" >&2; found=2; }
exit $found
