#!/usr/bin/env bash
# Installs what is needed, builds the loop and shows it at work: twelve seconds at 1 kHz against the in-process rig. Then
# builds the rest and shows a picture of the run, its log played back, two equal runs in virtual time, and the closed
# circle: a recording, the diagnosis of what the loop's model lacks, and the loop again with what was found, on another
# motion.
#
#   tools/run.sh [--config FILE] [--out DIR]
set -euo pipefail
cd "$(dirname "$0")/.."

refuse() {
  echo "tools/run.sh: $1, expected $2" >&2
  exit 2
}
# OPTION WHAT VALUE...: there is a value.
needs() { [ $# -gt 2 ] && [ -n "$3" ] || refuse "$1: no value" "$2"; }

config=firmware_app/config/adult.toml
out=runs/$(date +%Y%m%d-%H%M%S)
while [ $# -gt 0 ]; do
  case "$1" in
    --config) needs "$1" "a file" "${@:2}"; config=$2; shift 2 ;;
    --out) needs "$1" "a folder" "${@:2}"; out=$2; shift 2 ;;
    *) refuse "unknown argument '$1'" "--config FILE or --out DIR" ;;
  esac
done
# Before minutes of installing and building.
[ -f "$config" ] || refuse "--config: there is no file '$config'" "a run configuration, from $PWD"
[ ! -e "$out" ] || { [ -d "$out" ] && [ -z "$(ls -A "$out")" ]; } ||
  refuse "--out: '$out' is there already" "a new or empty folder"

tools/setup.sh
mkdir -p build
cmake --preset release >build/configure.log || { cat build/configure.log; exit 1; }

bin=build/release
headline() { printf '\n== %s\n' "$*"; }

# On a terminal, what Ninja says; elsewhere a line for every tenth of the work, and every line that is not progress.
progress() {
  local line tenth last=
  while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+), ]]; then
      tenth=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
      [ "$tenth" != "$last" ] || continue
      last=$tenth
    fi
    printf '%s\n' "$line"
  done
}
# Builds programs: build WHAT_FOR PROGRAM...
build() {
  headline "building $1"
  shift
  local -x NINJA_STATUS='[%f/%t, %e s] '
  if [ -t 1 ]; then
    cmake --build --preset release --target "$@"
  else
    cmake --build --preset release --target "$@" | progress
  fi
}

# The loop first, so that there is something to see; the rest waits until the run in wall-clock time is over.
build "the loop" patella
headline "1 kHz in wall-clock time against the in-process rig"
# A machine that takes the processor away for more than 5 ms makes the loop stop, as it must: encoder_stale, overrun. Such
# machines are many, and a second or third run mostly shows the rest.
for attempt in 1 2 3; do
  status=0
  $bin/firmware_app/patella run --config "$config" --out "$out/live" || status=$?
  [ "$status" = 3 ] || break
  echo "The loop stopped itself, for the causes above; this machine may have stood still. Run $attempt is kept."
  mv "$out/live" "$out/live-$attempt"
done
if [ "$status" = 3 ]; then
  echo "=================================================================="
  echo "NOT SHOWN in wall-clock time: this machine stopped the loop three times; the same run in virtual time:"
  echo "=================================================================="
  status=0
  $bin/firmware_app/patella run --config "$config" --clock virtual --out "$out/live" || status=$?
fi
[ "$status" = 0 ] || exit "$status"

build "the report" patella-report
$bin/tools/report/patella-report "$out/live" --png "$out/live/report.png"

headline "the same log played back"
$bin/firmware_app/patella run --config "$config" --backend "replay:$out/live/frames.log" --out "$out/replay" >/dev/null
tools/compare_columns.sh "$out/live/ticks.csv" "$out/replay/ticks.csv" 'f_(s|network)[12]_rad_s2'

headline "twice the same run in virtual time"
for copy in a b; do
  $bin/firmware_app/patella run --config "$config" --clock virtual --out "$out/virtual-$copy" >/dev/null
done
diff -r "$out/virtual-a" "$out/virtual-b"
echo "all files of $out/virtual-a and $out/virtual-b are identical"

build "the diagnosis" patella-diagnose
headline "what the model lacks, found in 40 s of motion and given to the loop, which then moves otherwise"
tools/studies/circle/circle.sh --bin "$bin" --out "$out/circle" firmware_app/config/models/adult_rubbing.toml

printf '\nPicture of the run: %s\n' "$out/live/report.html"
printf 'Diagnosis:          %s\n' "$out/circle/adult_rubbing/diagnosis/report.html"
