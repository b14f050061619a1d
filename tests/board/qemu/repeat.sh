#!/usr/bin/env bash
# repeat.sh SCENARIO ARTEFACTS [ARGUMENT...]: runs a scenario of the emulated board twice. Both must pass, and everything
# they leave must be the same to the last byte: the recording with its latencies, and what the console showed.
set -uo pipefail
run=$(dirname "$0")/../../../tools/board/run.sh
scenario=$1 artefacts=$2
shift 2
rm -rf "$artefacts"

for copy in first second; do
  status=0
  "$run" "$scenario" --artefacts "$artefacts/$copy" -- "$@" || status=$?
  [ "$status" = 0 ] || exit "$status"
done
if ! diff -rq "$artefacts/first" "$artefacts/second"; then
  echo "FAILED: two runs of $scenario in counted time differ, expected the same bytes in every artefact" >&2
  exit 1
fi
echo "two runs left the same bytes: $(cd "$artefacts/first" && find . -type f | sort | tr '\n' ' ')"
