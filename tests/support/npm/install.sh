#!/usr/bin/env bash
# Puts the packages of package-lock.json beside this script into a folder, once for each state of the lock file. Ends with
# 77, as a test that is skipped, where node or npm is absent or the registry cannot be reached.
#
#   tests/support/npm/install.sh FOLDER
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
folder=$1

skip() {
  printf '%s\nSKIPPED, nothing was held against programs of other authors: %s\n%s\n' "${line}" "$1" "${line}" >&2
  exit 77
}
line=$(printf '=%.0s' {1..90})

command -v node >/dev/null || skip "no node (package nodejs)"
command -v npm >/dev/null || skip "no npm (package npm)"
mkdir -p "$folder"
exec 9>"$folder/.lock"
flock 9  # tests run side by side
if ! cmp -s "$source/package-lock.json" "$folder/.installed"; then
  cp "$source/package.json" "$source/package-lock.json" "$folder/"
  (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1) ||
    skip "npm ci failed: $(tail -n 1 "$folder/npm.log")"
  cp "$source/package-lock.json" "$folder/.installed"
fi
