#!/usr/bin/env bash
# Runs clang-tidy over the product's sources (not the tests) with the compile commands of a build folder.
# With clang-tidy 22 where that is there: it takes half the time. Clang 14 does not parse libtorch's headers as C++20, so files
# named torch_* are left out.
# A file that passed is not looked at again until it, a header of the project that it includes, or the rules change; what
# passed is remembered in the user's cache folder, for every checkout.
#
#   tools/checks/tidy.sh BUILD_DIR      a folder that has been built: what includes what is known from there
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:?usage: tools/checks/tidy.sh BUILD_DIR}
[ -e "$build/build.ninja" ] || { echo "tidy.sh: '$build', expected a folder that was built with Ninja" >&2; exit 1; }
stamps=${XDG_CACHE_HOME:-$HOME/.cache}/patella-tidy
mkdir -p "$stamps"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
included=$scratch/included
# Clang cannot read what GCC has precompiled.
sed 's| -Winvalid-pch -include [^ ]*/cmake_pch\.hxx||' "$build/compile_commands.json" >"$scratch/compile_commands.json"
# Lines "SOURCE FILE": everything of the project that goes into a source, itself first.
ninja -C "$build" -t deps |
  awk '/#deps/ { source = ""; next } /^ +\.\.\/\.\.\// { sub(/^ +\.\.\/\.\.\//, ""); if (source == "") source = $0; print source, $0 }' |
  sort -u >"$included"
tidy=$(command -v clang-tidy-22 || command -v clang-tidy)
rules=$( (cat .clang-tidy tools/cmake/CompilerSettings.cmake; "$tidy" --version) | sha1sum | cut -c1-40)
export build scratch stamps included tidy rules
check() {
  local source=${1#"$PWD/"} files
  files=$(awk -v source="$source" '$1 == source { print $2 }' "$included")
  [ -n "$files" ] || { echo "tidy.sh: $source was not built in $build, expected a complete build" >&2; return 1; }
  stamp=$stamps/$( (echo "$rules $source"; cat $files) | sha1sum | cut -c1-40)
  [ -e "$stamp" ] && return 0
  "$tidy" --quiet -p "$scratch" --extra-arg=-Wno-unknown-warning-option "$1" 2>"$stamp.log" || { grep -v 'warnings generated' "$stamp.log" >&2; return 1; }
  rm -f "$stamp.log"
  touch "$stamp"
}
export -f check
grep -oE '"file": "[^"]+"' "$scratch/compile_commands.json" | cut -d'"' -f4 | sort -u |
  grep -E "^$PWD/(core|drivers|sim|firmware_app|tools)/" |
  grep -v '/torch_[a-z]*\.cpp$' |
  xargs -P "$(nproc)" -I{} bash -c 'check {}'
echo "clang-tidy has nothing to say"
