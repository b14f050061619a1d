#!/usr/bin/env bash
# Compares the columns of two CSV files whose names match a pattern, text for text. Numbers are written with all their
# digits, so equal text is equal to the last bit.
#
#   tools/compare_columns.sh A.csv B.csv PATTERN
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: tools/compare_columns.sh A.csv B.csv PATTERN" >&2; exit 2; }

columns() {
  awk -F, -v pattern="^($2)\$" '
    NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ pattern) keep[++n] = i
              if (n == 0) { print FILENAME ": no column matches " pattern > "/dev/stderr"; exit 1 } }
    { line = $keep[1]; for (k = 2; k <= n; ++k) line = line "," $keep[k]; print line }' "$1"
}

first=$(mktemp)
second=$(mktemp)
trap 'rm -f "$first" "$second"' EXIT
columns "$1" "$3" >"$first"
columns "$2" "$3" >"$second"
if ! cmp -s "$first" "$second"; then
  echo "$1 and $2 differ in $(head -n 1 "$first"):" >&2
  diff "$first" "$second" | sed -n 1,6p >&2 || true
  exit 1
fi
echo "$(head -n 1 "$first"): equal to the last bit in $(($(wc -l <"$first") - 1)) ticks"
