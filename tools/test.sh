#!/usr/bin/env bash
# Installs what testing needs, builds, and runs every check.
#
#   tools/test.sh            everything: style, unit, integration, board tests, all sanitizers, arm64 under emulation
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
# build PRESET TARGET [CMAKE_ARGUMENT...]
build() {
  local preset=$1 target=$2
  shift 2
  headline "build: $preset"
  mkdir -p build
  cmake --preset "$preset" "$@" >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
  cmake --build --preset "$preset" --target "$target"
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

cross=0
tools/setup.sh --cross || cross=$?
if [ "$cross" -eq 0 ]; then
  build arm64 all
  headline "tests: arm64, under user emulation and on the emulated board"
  ctest --preset arm64 -j "$(nproc)"
elif [ "$cross" -eq 77 ]; then
  echo "SKIPPED: arm64 and the emulated board need packages that cannot be had here (tools/setup.sh --cross)"
else
  exit "$cross"
fi

headline "lint"
tools/checks/tidy.sh build/release
