#!/usr/bin/env bash
# Holds the readers of configuration, models and scripts against core/bounds: a number is read by its row, not by a range
# that stands beside it. Effects bring ranges of their own (core/model/effect.hpp).
#
#   tools/checks/bounds.sh [ROOT]
set -euo pipefail
root=${1:-$(dirname "$0")/../..}
cd "$root"
status=0
# Only the definition of a range, and the conversion of a row into one, may name them.
while IFS=: read -r file line text; do
  [ -n "$file" ] || continue
  echo "$file:$line: '$text' reads a number without a row of core/bounds" >&2
  status=1
done < <(grep -rnE 'kAnyNumber|kPositive|Range\{|\.(number|numbers|integer)\(' firmware_app --include='*.cpp' --include='*.hpp' |
  grep -vE '^firmware_app/files/(toml_table|bounded)\.[ch]pp:' |
  grep -vE 'CountRange\{|table\.number\(parameter\.name, range|const Range range\{\.minimum = parameter\.minimum|"joint", 1, joints|(metadata|parser)\.(number|numbers|integer)\(' |
  sed -E 's/^([^:]+:[0-9]+:) +/\1/' || true)
[ "$status" -ne 0 ] || echo "every number of the loop and the rig is read by its row of core/bounds"
exit "$status"
