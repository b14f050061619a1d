#!/usr/bin/env bash
# Colours of pictures have one home: a source that writes one as '#RRGGBB' instead of taking it from the palette is named.
# The style sheet of pages, which no picture uses, is not looked at.
#
#   tools/checks/palette.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/../..}"
palette=tools/report/palette.hpp
[ "$(grep -cE '"#[0-9A-F]{6}"' "$palette")" -gt 0 ] || { echo "$palette: no colour in it" >&2; exit 1; }
twice=$(grep -oE '#[0-9A-F]{6}' "$palette" | sort | uniq -d)
[ -z "$twice" ] || { echo "$palette: $twice has two names" >&2; exit 1; }
found=$(grep -rnE "[\"'>]#[0-9A-Fa-f]{6}[\"']" core drivers sim firmware_app tools --include='*.hpp' --include='*.cpp' |
  grep -v "^$palette:" || true)
[ -z "$found" ] || { printf '%s\n' "$found" "colours stand in $palette" >&2; exit 1; }
echo "$(grep -cE '"#[0-9A-F]{6}"' "$palette") colours, all of them in $palette"
