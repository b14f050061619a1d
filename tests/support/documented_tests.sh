#!/usr/bin/env bash
# Every test that docs/safety.md names must exist: `FOLDER/FILE: title` with FOLDER below tests/, where the title is that
# of a TEST_CASE of the file, or `FOLDER/SCRIPT.sh`.
#
#   tests/support/documented_tests.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/../..}"
status=0
count=0
while IFS= read -r name; do
  count=$((count + 1))
  file=tests/${name%%: *}
  title=${name#*: }
  if [ ! -f "$file" ]; then
    echo "docs/safety.md: '$name': there is no $file" >&2
    status=1
  elif [[ $file != *.sh ]] && ! tr -d '\n' <"$file" | sed -E 's/"[[:space:]]+"//g' | grep -qF "TEST_CASE(\"$title\")" &&
    ! tr -d '\n' <"$file" | sed -E 's/"[[:space:]]+"//g; s/TEST_CASE\([[:space:]]+/TEST_CASE(/g' | grep -qF "TEST_CASE(\"$title\")"; then
    echo "docs/safety.md: '$name': $file has no such test case" >&2
    status=1
  fi
done < <(grep -E '^\|' docs/safety.md | grep -oE '`(unit|integration|board|fuzz)/[^`]+`' | tr -d '`' | sort -u)
[ "$count" -ge 20 ] || { echo "docs/safety.md: names $count tests, expected at least 20" >&2; status=1; }
# A row of the safety functions without a test claims what nobody has shown.
if grep -E '^\| H[0-9]+:' docs/safety.md | grep -vE '`(unit|integration|board|fuzz)/'; then
  echo "docs/safety.md: the rows above name no test" >&2
  status=1
fi
[ "$status" -ne 0 ] || echo "$count tests named by docs/safety.md exist"
exit "$status"
