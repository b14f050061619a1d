#!/usr/bin/env bash
# The check of the palette must find what is wrong, and only that: palette_control.sh CHECK
set -euo pipefail
. "$(dirname "$0")/check_control.sh" "$1"
mkdir -p "$root"/{core,drivers,sim,firmware_app,tools/report,tools/train}
palette=$root/tools/report/palette.hpp
cp "$(dirname "$1")/../report/palette.hpp" "$palette"
expect 0 "colours, all of them in tools/report/palette.hpp"

for written in '"#0072B2"' "\"lc rgb '#0072b2'\""; do
  echo "constexpr const char* kBlue = $written;" >"$root/tools/train/curves.cpp"
  expect 1 "tools/train/curves.cpp:1:"
done
echo 'constexpr const char* kIdentifier = "202#0072B200";' >"$root/tools/train/curves.cpp"
expect 0 "colours, all of them"

echo 'inline constexpr const char* kOtherBlue = "#0072B2";' >>"$palette"
expect 1 "#0072B2 has two names"
: >"$palette"
expect 1 "no colour in it"
