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

# may_include FOLDER OF ALLOWED: of what stands in the folder OF, FOLDER may include only what matches ALLOWED.
may_include() {
  [ -e "$1" ] || return 0
  while IFS=: read -r file line text; do
    [ -n "$file" ] || continue
    fail "$file:$line: includes $text; $1 may include of $2 only ${3//|/, }"
  done < <(sources "$1" | xargs -r grep -nHoE "^#include \"$2/[^\"]+\"" | sed -E 's/#include "([^"]+)"/\1/' |
    grep -vE ":$2/($3)(/|$)" || true)
}
# rooms FOLDER ROOM...: each room, a folder or a header, may include itself and those before it.
rooms() {
  local folder=$1 allowed="" room
  shift
  for room; do
    allowed=${allowed:+$allowed|}$room
    may_include "$folder/$room" "$folder" "$allowed"
  done
}
# In the way that a recording goes, the thresholds of all of it first.
rooms tools/diagnose thresholds.hpp result regression effects fit checks search verdict plan output
# The loop tells a sink what it did and knows nobody who keeps account.
rooms firmware_app files formats live weights realtime loop configuration recorder commands
# Only benchmarks and studies run the loop.
for tool in tools/*/; do
  case $tool in
    tools/bench/ | tools/studies/) ;;
    *) may_include "${tool%/}" firmware_app "files|formats|live|weights|configuration" ;;
  esac
done

[ "$status" -ne 0 ] || echo "dependencies point one way: ${order[*]}"
exit "$status"
