#!/usr/bin/env bash
# Holds every #include against the order core <- drivers <- sim <- firmware_app <- tools: a folder may include itself
# and what stands before it. core may include nothing but Eigen, the standard library and the compiler's
# vector instructions besides.
#
#   tools/checks/dependencies.sh [ROOT]
set -euo pipefail
root=${1:-$(dirname "$0")/../..}
cd "$root"
order=(core drivers sim firmware_app tools)
status=0

fail() {
  echo "$1" >&2
  status=1
}

sources() { find "$1" -name '*.hpp' -o -name '*.cpp' -o -name '*.h' | sort; }

for index in "${!order[@]}"; do
  folder=${order[$index]}
  [ -d "$folder" ] || continue
  allowed=$(IFS='|'; echo "${order[*]:0:index+1}")
  while IFS=: read -r file line text; do
    [ -n "$file" ] || continue
    fail "$file:$line: includes $text; $folder may include only ${allowed//|/, }"
  done < <(sources "$folder" | xargs -r grep -nHoE '^#include "[^"]+"' | sed -E 's/#include "([^"]+)"/\1/' |
    grep -vE ":($allowed)/" || true)
done

# The standard library's headers have neither a slash nor a suffix.
while IFS=: read -r file line text; do
  [ -n "$file" ] || continue
  fail "$file:$line: includes $text; core may include only Eigen, the C++ standard library and vector instructions"
done < <(sources core | xargs -r grep -nHoE '^#include <[^>]+>' | sed -E 's/#include <([^>]+)>/\1/' |
  grep -vE ':(Eigen/[A-Za-z]+|[a-z_0-9]+|[ei]mmintrin\.h|arm_neon\.h)$' || true)

# Rooms of the diagnosis, in the way that a recording goes: each may include itself and what stands before it.
rooms=(result regression effects fit checks search verdict output)
for index in "${!rooms[@]}"; do
  room=tools/diagnose/${rooms[$index]}
  [ -d "$room" ] || continue
  allowed=$(IFS='|'; echo "${rooms[*]:0:index+1}")
  while IFS=: read -r file line text; do
    [ -n "$file" ] || continue
    fail "$file:$line: includes $text; $room may include of the diagnosis only ${allowed//|/, }"
  done < <(sources "$room" | xargs -r grep -nHoE '^#include "tools/diagnose/[^"]+"' | sed -E 's/#include "([^"]+)"/\1/' |
    grep -vE ":tools/diagnose/($allowed)/" || true)
done

[ "$status" -ne 0 ] || echo "dependencies point one way: ${order[*]}"
exit "$status"
