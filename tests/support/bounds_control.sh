#!/usr/bin/env bash
# The check of bounds must find what is wrong, and only that: bounds_control.sh CHECK
set -euo pipefail
. "$(dirname "$0")/check_control.sh" "$1"
mkdir -p "$root/firmware_app/files" "$root/firmware_app/configuration"

file=$root/firmware_app/configuration/reader.cpp
echo 'inline constexpr Range kAnyNumber{};' >"$root/firmware_app/files/toml_table.hpp"
echo 'x = number(table, boundOf("loop.rate_Hz"), x);' >"$file"
expect 0 "every number"
for bad in 'x = table.number("rate_Hz", kPositive, x);' 'x = table.numbers("q", count, range);' \
  'n = table.integer("ticks", 1, 100, n);' 'constexpr Range kRate{};' 'f(Range{.minimum = 0.0});'; do
  printf '// a comment\n  %s\n' "$bad" >"$file"
  case $bad in
    constexpr*) expect 0 "every number" ;;  # of no use without a getter that takes it
    *) expect 1 "firmware_app/configuration/reader.cpp:2: '$bad' reads a number without a row" ;;
  esac
done
