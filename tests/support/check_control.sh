# Common part of the controls of the checks. To be sourced, with the check's path as $1; leaves an empty tree in $root.
set -euo pipefail
check=$1
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

expect() {  # expect STATUS TEXT
  status=0
  output=$("$check" "$root" 2>&1) || status=$?
  if [ "$status" -ne "$1" ] || ! grep -qF "$2" <<<"$output"; then
    echo "status $status, expected $1, with '$2' in:" >&2
    echo "$output" >&2
    exit 1
  fi
}
