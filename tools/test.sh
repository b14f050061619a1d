#!/usr/bin/env bash
# Installs what testing needs, builds, and runs every check.
#
#   tools/test.sh            style, unit and integration tests, User-mode Linux, the emulated board, all sanitizers, lint
#   tools/test.sh --quick    the release build's fast tests, for use while working
#   tools/test.sh --package  only the Debian package, of this machine and of arm64: build; install, run, remove and purge
#   tools/test.sh --release  only the release of what is committed: made twice, in two places, the same bytes
#   tools/test.sh --board    only the emulated board (docs/board.md), and every unit test under emulation of arm64
set -euo pipefail
cd "$(dirname "$0")/.."

quick=false
board=false
package=false
release=false
case "${1:-}" in
  "") ;;
  --quick) quick=true ;;
  --board) board=true ;;
  --package) package=true ;;
  --release) release=true ;;
  *)
    echo "tools/test.sh: unknown argument '$1', expected --quick, --board, --package, --release or nothing" >&2
    exit 2
    ;;
esac

# Each part begins with its name and the seconds since the start; the end says how long each took.
parts=()
headline() {
  parts+=("$SECONDS $*")
  printf '\n== [%4d s] %s\n' "$SECONDS" "$*"
}
times() {
  local index next
  headline "end"
  for ((index = 0; index < ${#parts[@]} - 1; ++index)); do
    next=${parts[index + 1]%% *}
    printf '%6d s  %s\n' "$((next - ${parts[index]%% *}))" "${parts[index]#* }"
  done
}
# build PRESET "TARGET..." [CMAKE_ARGUMENT...]
build() {
  local preset=$1 targets
  read -ra targets <<<"$2"
  shift 2
  headline "build: $preset"
  mkdir -p build
  cmake --preset "$preset" "$@" >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
  cmake --build --preset "$preset" --target "${targets[@]}"
}

# In wall time, in an emulated kernel, a loop stops where the host takes the processor away for long: once more, then.
again=(--repeat until-pass:2)

# Tests of the release build. Those that keep wall time (User-mode Linux, the page in a browser) sleep most of it; the others
# run then, and give way to them.
run_release_tests() {
  local failed=0 others
  chrt --idle 0 ctest --preset release -j "$(($(nproc) + 1))" -LE wall_time &
  others=$!
  ctest --preset release -j "$(nproc)" "${again[@]}" -L wall_time >build/release/wall_time.log 2>&1 || failed=$?
  wait "$others" || failed=$?
  cat build/release/wall_time.log
  return "$failed"
}

skipped=()
skip() {
  echo "=================================================================="
  echo "SKIPPED: $*"
  echo "=================================================================="
  skipped+=("$*")
}

# run_board all|TEST...: the emulated board's scenarios, and unit tests under emulation.
run_board() {
  local cross=0 filter
  tools/setup.sh --cross || cross=$?
  if [ "$cross" -eq 77 ]; then
    skip "$(ls tests/board/qemu/scenarios/*.sh | wc -l) scenarios on the emulated board, and unit tests for arm64:" \
      "their packages cannot be had here (tools/setup.sh --cross)"
    return 0
  elif [ "$cross" -ne 0 ]; then
    return "$cross"
  fi
  if [ "$1" = all ]; then
    build arm64 all
    filter=.
  else
    build arm64 "patella_board $*"
    filter="^(board_.*|$(IFS='|'; echo "$*"))$"
  fi
  headline "tests: arm64, under user emulation and on the emulated board"
  ctest --preset arm64 -j "$(nproc)" "${again[@]}" -R "$filter"
}

if $board; then
  run_board all
  exit 0
fi

# The programs of the package, then the package.
run_package() {
  local preset=$1 status=0
  build "$preset" patella_package
  headline "package: $preset"
  rm -f "build/$preset"/*.deb
  (cd "build/$preset" && cpack -G DEB >cpack.log 2>&1) || { cat "build/$preset/cpack.log"; exit 1; }
  tests/package/test_package.sh "build/$preset"/*.deb || status=$?
  if [ "$status" -eq 77 ]; then
    skip "installing $(basename "build/$preset"/*.deb)"
    return 0
  fi
  return "$status"
}
if $package; then
  tools/setup.sh --test
  run_package release
  cross=0
  tools/setup.sh --cross || cross=$?
  if [ "$cross" -eq 77 ]; then
    skip "the package for arm64: its packages cannot be had here (tools/setup.sh --cross)"
  elif [ "$cross" -ne 0 ]; then
    exit "$cross"
  else
    run_package arm64
  fi
  exit 0
fi

if $release; then
  tools/setup.sh --test
  architectures=(--architecture "$(dpkg --print-architecture)")
  cross=0
  tools/setup.sh --cross || cross=$?
  if [ "$cross" -eq 77 ]; then
    skip "the release for arm64: its packages cannot be had here (tools/setup.sh --cross)"
  elif [ "$cross" -ne 0 ]; then
    exit "$cross"
  else
    architectures+=(--architecture arm64)
  fi
  # The second one is compiled anew: a compiler's cache would give what it gave the first.
  for time in first second; do
    headline "release: the $time time"
    [ "$time" = first ] || export CCACHE_DISABLE=1
    tools/release.sh --out "build/release-$time" "${architectures[@]}"
  done
  diff -r build/release-first build/release-second
  echo "both releases are the same to the last byte"
  exit 0
fi

tools/setup.sh --test

build release all
if $quick; then
  ctest --preset release -L fast -j "$(nproc)"
  exit 0
fi

headline "style"
tools/checks/dependencies.sh
tools/checks/bounds.sh
tools/checks/thresholds.sh
tools/checks/palette.sh
tools/checks/format.sh
headline "documentation of the API"
tools/checks/api.sh
headline "tests: release, and User-mode Linux"
run_release_tests

# The unit tests that depend on processor or libraries: byte order, the heap's symbols, the lines.
run_board allocation_counter_test can_test gpiod_pins_test

# Where it is there, clang builds every sanitizer: in half the time that GCC takes.
compiler=()
if command -v clang++-22 >/dev/null; then
  compiler=(-DCMAKE_CXX_COMPILER=clang++-22)
fi
build asan patella_tests "${compiler[@]}"
headline "tests: asan"
ctest --preset asan -j "$(nproc)"
for preset in tsan rtsan; do
  if [ "$preset" = rtsan ] && [ ${#compiler[@]} -eq 0 ]; then
    skip "RealtimeSanitizer needs clang++-22, which this distribution does not carry"
    continue
  fi
  build "$preset" patella_tests "${compiler[@]}"
  headline "tests: $preset"
  ctest --preset "$preset" -j "$(nproc)"
done

headline "fuzz: what is in the tree, and some seconds of chance"
tests/fuzz/run.sh short

headline "lint"
tools/checks/tidy.py build/release

times
if [ ${#skipped[@]} -gt 0 ]; then
  printf '\n== %s\n' "passed, but for ${#skipped[@]} parts that were SKIPPED"
  printf '  %s\n' "${skipped[@]}"
fi
