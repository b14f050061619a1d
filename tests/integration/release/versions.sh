#!/usr/bin/env bash
# One version: that of CMakeLists.txt, in every program and every text that states one.
#
#   versions.sh BUILD_DIR VERSION PROGRAM...
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
build=${1:?"usage: versions.sh BUILD_DIR VERSION PROGRAM..."}
version=$2
shift 2
status=0
# states WHAT FOUND: they agree.
states() {
  [ "$2" = "$version" ] && return
  echo "$1 states version '$2', expected $version as in CMakeLists.txt" >&2
  status=1
}
states CMakeLists.txt "$(sed -nE 's/^project\(patella VERSION ([^ ]+) .*/\1/p' "$source_dir/CMakeLists.txt")"
for program in "$@"; do
  name=$(basename "$program")
  states "$name --version" "$("$program" --version | sed -nE "s/^$name ([^ ,]+).*/\1/p")"
done
states "CITATION.cff" "$(sed -nE "s/^version: *[\"']?([^\"']+)[\"']?$/\1/p" "$source_dir/CITATION.cff")"
states "the newest entry of CHANGELOG.md" \
  "$(sed -nE 's/^## \[?v?([0-9]+\.[0-9]+\.[0-9]+).*/\1/p' "$source_dir/CHANGELOG.md" | sed -n 1p)"
states "the Debian package" "$(sed -nE 's/^set\(CPACK_PACKAGE_VERSION "(.*)"\)$/\1/p' "$build/CPackConfig.cmake")"
states "the CMake package" "$(sed -nE 's/^set\(PACKAGE_VERSION "(.*)"\)$/\1/p' "$build/patellaConfigVersion.cmake")"
# Names of packages, archives and tags in documents.
while IFS=: read -r file line found; do
  states "$file:$line" "$found"
done < <(cd "$source_dir" && grep -rnoE 'patella[_-][0-9]+\.[0-9]+\.[0-9]+' README.md docs --include='*.md' | sed -E 's/patella[_-]([0-9.]+)$/\1/')
[ "$status" -ne 0 ] || echo "version $version, in $# programs and everywhere else"
exit "$status"
