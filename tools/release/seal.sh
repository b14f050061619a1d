#!/usr/bin/env bash
# Seals a folder of release files: SHA256SUMS over all of them, and its signature SHA256SUMS.minisig where a key is given.
#
#   tools/release/seal.sh FOLDER "COMMENT" [KEY]     COMMENT is signed, too; KEY is a secret key of minisign
#
# Who downloads them checks:  minisign -Vm SHA256SUMS -p patella.pub && sha256sum --check SHA256SUMS
set -euo pipefail
folder=${1:?'usage: seal.sh FOLDER "COMMENT" [KEY]'}
comment=${2:?'usage: seal.sh FOLDER "COMMENT" [KEY]'}
key=${3:-}
if [ -n "$key" ]; then
  [ -r "$key" ] || { echo "seal.sh: key '$key' cannot be read, expected a secret key of minisign" >&2; exit 1; }
  command -v minisign >/dev/null || { echo "seal.sh: no minisign (package minisign), which signing needs" >&2; exit 1; }
  key=$(realpath "$key")
fi
cd "$folder"
rm -f SHA256SUMS SHA256SUMS.minisig
files=$(find . -maxdepth 1 -type f -printf '%P\n' | LC_ALL=C sort)
[ -n "$files" ] || { echo "seal.sh: nothing to seal in $folder" >&2; exit 1; }
xargs -d '\n' sha256sum -- <<<"$files" >SHA256SUMS
if [ -n "$key" ]; then
  minisign -S -s "$key" -m SHA256SUMS -c "$comment" -t "$comment"
else
  echo "not signed: no key was given"
fi
