#!/usr/bin/env bash
# Installs what testing needs, builds, and runs every check.
#
#   tools/test.sh            everything: style, unit, integration, board tests, all sanitizers
#   tools/test.sh --quick    the release build's fast tests, for use while working
set -euo pipefail
cd "$(dirname "$0")/.."

quick=false
case "${1:-}" in
  "") ;;
  --quick) quick=true ;;
  *)
    echo "tools/test.sh: unknown argument '$1', expected --quick or nothing" >&2
    exit 2
    ;;
esac

headline() { printf '\n== %s\n' "$*"; }
# build PRESET TARGET
build() {
  headline "build: $1"
  mkdir -p build
  cmake --preset "$1" >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
  cmake --build --preset "$1" --target "$2"
}

tools/setup.sh --test

build release all
if $quick; then
  ctest --preset release -L fast -j "$(nproc)"
  exit 0
fi

headline "style"
tools/checks/dependencies.sh
tools/checks/format.sh
headline "tests: release"
ctest --preset release -j "$(nproc)"

for preset in asan tsan rtsan; do
  if [ "$preset" = rtsan ] && ! command -v clang++-22 >/dev/null; then
    echo "SKIPPED: RealtimeSanitizer needs clang++-22, which this distribution does not carry"
    continue
  fi
  build "$preset" patella_tests
  headline "tests: $preset"
  ctest --preset "$preset" -j "$(nproc)"
done

headline "lint"
tools/checks/tidy.sh build/release
