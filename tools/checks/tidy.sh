#!/usr/bin/env bash
# Runs clang-tidy over the product's sources (not the tests) with the compile commands of a build folder.
# Clang 14 does not parse libtorch's headers as C++20, so files named torch_* are left out.
# A file that passed is not looked at again until it, a header, or the rules change; what passed is remembered in the
# user's cache folder, for every checkout.
#
#   tools/checks/tidy.sh BUILD_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:?usage: tools/checks/tidy.sh BUILD_DIR}
stamps=${XDG_CACHE_HOME:-$HOME/.cache}/patella-tidy
mkdir -p "$stamps"
export build stamps
rules=$(cat .clang-tidy tools/cmake/CompilerSettings.cmake $(find core drivers sim firmware_app tools -name '*.hpp' | sort) | sha1sum | cut -c1-40)
export rules
check() {
  stamp=$stamps/$( (echo "$rules ${1#"$PWD/"}"; cat "$1") | sha1sum | cut -c1-40)
  [ -e "$stamp" ] && return 0
  clang-tidy --quiet -p "$build" --extra-arg=-Wno-unknown-warning-option "$1" 2>"$stamp.log" || { grep -v 'warnings generated' "$stamp.log" >&2; return 1; }
  rm -f "$stamp.log"
  touch "$stamp"
}
export -f check
grep -oE '"file": "[^"]+"' "$build/compile_commands.json" | cut -d'"' -f4 | sort -u |
  grep -E "^$PWD/(core|drivers|sim|firmware_app|tools)/" |
  grep -v '/torch_[a-z]*\.cpp$' |
  xargs -P "$(nproc)" -I{} bash -c 'check {}'
echo "clang-tidy has nothing to say"
