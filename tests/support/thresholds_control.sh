#!/usr/bin/env bash
# The check of thresholds must find what is wrong, and only that: thresholds_control.sh CHECK
set -euo pipefail
. "$(dirname "$0")/check_control.sh" "$1"
project=$(dirname "$1")/../..
mkdir -p "$root/tools" "$root/docs"
cp -r "$project/tools/diagnose" "$root/tools/"
cp "$project/docs/diagnosis.md" "$root/docs/"
expect 0 "thresholds decide"

for room in fit checks search verdict; do
  bad=$root/tools/diagnose/$room/bad.cpp
  printf '// a comment\n  constexpr double kLeastOfAll = 0.5;\n' >"$bad"
  expect 1 "tools/diagnose/$room/bad.cpp:2: kLeastOfAll is no numerics"
  rm "$bad"
done

file=$root/tools/diagnose/verdict/power.cpp
cp "$file" "$root/kept.cpp"
sed -i '/constexpr double kNever/d' "$file"
expect 1 "verdict/kNever is in no file"
mv "$root/kept.cpp" "$file"

sed -i 's/double kMaterialRest = 0.2;/double kMaterialRest = 0.3;/' "$root/tools/diagnose/thresholds.hpp"
expect 1 "docs/diagnosis.md: its table of thresholds is not that of"
