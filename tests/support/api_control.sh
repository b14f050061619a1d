#!/usr/bin/env bash
# The check of the API's documentation must be able to fail: a parameter that no function has, and a name that nothing bears.
#
#   tests/support/api_control.sh SCRIPT
set -euo pipefail
script=$(realpath "${1:?usage: api_control.sh SCRIPT}")
root=$(cd "$(dirname "$script")/../.." && pwd)
command -v doxygen >/dev/null || { echo "SKIPPED: no doxygen (tools/setup.sh --test)" >&2; exit 77; }
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
mkdir -p "$copy/docs/examples" "$copy/core" "$copy/drivers" "$copy/sim"
cp "$root/docs/Doxyfile" "$copy/docs/"
cp "$root/CMakeLists.txt" "$copy/"
for folder in docs/examples core drivers sim; do
  printf '/// A number.\ninline int number%s(int value) { return value; }\n' "${folder##*/}" >"$copy/$folder/good.hpp"
done
"$script" "$copy" >"$copy/log" 2>&1 || { cat "$copy/log"; echo "a sound header is refused" >&2; exit 1; }
# refuses TEXT WORDS
refuses() {
  printf '%s\n' "$1" >"$copy/core/bad.hpp"
  ! "$script" "$copy" >"$copy/log" 2>&1 || { echo "passed: $1" >&2; exit 1; }
  grep -q "core/bad.hpp:[0-9]*: .*$2" "$copy/log" || { cat "$copy/log"; echo "nothing says '$2'" >&2; exit 1; }
}
refuses $'/// Twice.\n/// @param amount which it does not have\ninline int twice(int value) { return 2 * value; }' "amount"
refuses $'/// See \\ref nowhere_at_all.\ninline int half(int value) { return value / 2; }' "nowhere_at_all"
echo "the check of the API's documentation finds what is wrong"
