#!/usr/bin/env bash
# Puts the packages of a lock file into a folder, once for each state of that file. Ends with 77 where node or npm is absent
# or the registry cannot be reached, and says what is therefore left out.
#
#   tools/npm_packages.sh FOLDER_OF_LOCK_FILE FOLDER WHAT_IS_LEFT_OUT
set -euo pipefail
source=$(cd "$1" && pwd)
folder=$2

skip() {
  printf '%s\nSKIPPED, %s: %s\n%s\n' "${line}" "$left_out" "$1" "${line}" >&2
  exit 77
}
left_out=$3
line=$(printf '=%.0s' {1..90})

command -v node >/dev/null || skip "no node (package nodejs)"
command -v npm >/dev/null || skip "no npm (package npm)"
mkdir -p "$folder"
exec 9>"$folder/.lock"
flock 9  # tests run side by side
if ! cmp -s "$source/package-lock.json" "$folder/.installed"; then
  cp "$source/package.json" "$source/package-lock.json" "$folder/"
  (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=30000 >npm.log 2>&1) ||
    skip "npm ci failed: $(tail -n 1 "$folder/npm.log")"
  cp "$source/package-lock.json" "$folder/.installed"
fi
