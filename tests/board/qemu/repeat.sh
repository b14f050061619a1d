#!/usr/bin/env bash
# repeat.sh SCENARIO ARTEFACTS [ARGUMENT...]: runs a scenario of the emulated board twice. Both must pass, and everything
# they leave must be the same to the last byte: the recording with its latencies, and what the console showed.
#
# On a host with many more programs than processors QEMU once delivered a timer some tens of nanoseconds later in one of
# two runs. A third run then has to be the same as one of them.
set -uo pipefail
run=$(dirname "$0")/../../../tools/board/run.sh
scenario=$1 artefacts=$2
shift 2
rm -rf "$artefacts"

# once COPY: runs it, and says whether an earlier copy is the same.
once() {
  local earlier status=0
  "$run" "$scenario" --artefacts "$artefacts/$1" -- "${arguments[@]}" || status=$?
  [ "$status" = 0 ] || exit "$status"
  for earlier in first second; do
    if [ "$earlier" != "$1" ] && [ -d "$artefacts/$earlier" ] &&
      diff -rq "$artefacts/$earlier" "$artefacts/$1"; then
      echo "$earlier and $1 run left the same bytes: $(cd "$artefacts/$1" && find . -type f | sort | tr '\n' ' ')"
      exit 0
    fi
  done
}

arguments=("$@")
once first
once second
echo "repeat.sh: two runs of $scenario in counted time differ; a third decides" >&2
once third
echo "FAILED: no two of three runs of $scenario in counted time are the same, expected the same bytes in every artefact" >&2
exit 1
