#!/usr/bin/env bash
# Installs what testing needs, builds, and runs every check.
#
#   tools/test.sh            style, unit and integration tests, User-mode Linux, all sanitizers, lint
#   tools/test.sh --quick    the release build's fast tests, for use while working
#   tools/test.sh --board    arm64: cross build, its tests under emulation, the emulated board (docs/board.md)
set -euo pipefail
cd "$(dirname "$0")/.."

quick=false
board=false
case "${1:-}" in
  "") ;;
  --quick) quick=true ;;
  --board) board=true ;;
  *)
    echo "tools/test.sh: unknown argument '$1', expected --quick, --board or nothing" >&2
    exit 2
    ;;
esac

headline() { printf '\n== %s\n' "$*"; }
# build PRESET TARGET [CMAKE_ARGUMENT...]
build() {
  local preset=$1 target=$2
  shift 2
  headline "build: $preset"
  mkdir -p build
  cmake --preset "$preset" "$@" >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
  cmake --build --preset "$preset" --target "$target"
}

if $board; then
  cross=0
  tools/setup.sh --cross || cross=$?
  if [ "$cross" -eq 77 ]; then
    echo "SKIPPED: arm64 and the emulated board need packages that cannot be had here (tools/setup.sh --cross)"
    exit 0
  elif [ "$cross" -ne 0 ]; then
    exit "$cross"
  fi
  build arm64 all
  headline "tests: arm64, under user emulation and on the emulated board"
  exec ctest --preset arm64 -j "$(nproc)"
fi

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

# Where it is there, clang builds every sanitizer: in half the time that GCC takes.
compiler=()
if command -v clang++-22 >/dev/null; then
  compiler=(-DCMAKE_CXX_COMPILER=clang++-22)
fi
for preset in asan tsan rtsan; do
  if [ "$preset" = rtsan ] && [ ${#compiler[@]} -eq 0 ]; then
    echo "SKIPPED: RealtimeSanitizer needs clang++-22, which this distribution does not carry"
    continue
  fi
  build "$preset" patella_tests "${compiler[@]}"
  headline "tests: $preset"
  ctest --preset "$preset" -j "$(nproc)"
done

headline "fuzz: what is in the tree, and some seconds of chance"
tests/fuzz/run.sh short

headline "lint"
tools/checks/tidy.sh build/release
