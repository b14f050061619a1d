#!/usr/bin/env bash
# Bad arguments are refused with exit status 1 and by name, before anything is measured or written.
#
#   arguments.sh PATELLA_BENCH_PAPER
set -uo pipefail
study=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "arguments.sh: $*" >&2; exit 1; }

refused() {  # WORD ARGUMENT…
  local word=$1
  shift
  "$study" --out "$folder/out" "$@" >/dev/null 2>"$folder/message.txt"
  local status=$?
  [ $status -eq 1 ] || fail "$*: exit status $status, expected 1"
  grep -q -- "$word" "$folder/message.txt" || fail "$*: '$word' is not in: $(cat "$folder/message.txt")"
  [ ! -e "$folder/out" ] || fail "$*: something was written"
}

refused experiments --experiments 3
refused splits --splits sideways
refused forms --forms handwritten
refused rate-Hz --rate-Hz 300
refused heads --heads 7
refused seeds --seeds 0
refused only-observers --only-networks --only-observers
"$study" --help | grep -q 'figures 3 to 10' || fail "--help does not say what it is for"
