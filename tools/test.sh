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

# Each part begins with its name and the seconds since the start.
headline() { printf '\n== [%4d s] %s\n' "$SECONDS" "$*"; }
# build PRESET "TARGET..." [CMAKE_ARGUMENT...]
build() {
  local preset=$1 targets
  read -ra targets <<<"$2"
  shift 2
  headline "build: $preset"
  mkdir -p build
  cmake --preset "$preset" "$@" >"build/configure-$preset.log" 2>&1 || { cat "build/configure-$preset.log"; exit 1; }
  cmake --build --preset "$preset" --target "${targets[@]}"
}

# In wall time, in an emulated kernel, a loop stops where the host takes the processor away for long: once more, then.
again=(--repeat until-pass:2)

skip() {
  echo "=================================================================="
  echo "SKIPPED: $*"
  echo "=================================================================="
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
    build arm64 all || return
    filter=.
  else
    build arm64 "patella_board $*" || return
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

# From here on several parts run at a time, each of which leaves its output in a file of its own.
logs=build/parts
rm -rf "$logs"
mkdir -p "$logs"

# part NAME COMMAND...: runs a part, shows its tests as they end, and says how it went; its whole output where it failed.
part() {
  local name=$1 begin=$SECONDS status
  local log=$logs/${name//[^A-Za-z0-9]/_}.log
  shift
  headline "begins: $name"
  set +e
  ("$@") 2>&1 | tee "$log" | grep --line-buffered -E '^ *[0-9]+/[0-9]+ Test'
  status=${PIPESTATUS[0]}
  set -e
  if [ "$status" -eq 0 ]; then
    headline "passed: $name"
    # What did not run is said loudly.
    sed -n '/tests passed/p; /did not run/,/^$/p; /SKIPPED/p; /executions in/p; /clang-tidy/p' "$log"
  else
    cat "$log"
    headline "FAILED: $name"
  fi
  printf '%6d s  %s\n' "$((SECONDS - begin))" "$name" >>"$logs/times"
  return "$status"
}

# beside_others NAME CTEST_ARGUMENT...: a part of the release build's tests. A host that is busy takes processors away for so
# long that an emulated loop stops and a program runs out of its time: what fails here counts when it fails alone, too.
beside_others() {
  local name=$1 status=0 names
  shift
  part "$name" ctest --preset release "$@" || status=$?
  [ "$status" -ne 0 ] || return 0
  names=$(sed -n '/^The following tests FAILED:/,/^Errors while/s/^[[:space:]]*[0-9]* - \([^ ]*\) .*/\1/p' \
    "$logs/${name//[^A-Za-z0-9]/_}.log")
  [ -n "$names" ] || return "$status"
  echo "$names" >>"$logs/failed"
}

check_style() {
  tools/checks/dependencies.sh && tools/checks/bounds.sh && tools/checks/thresholds.sh && tools/checks/palette.sh &&
    tools/checks/format.sh && tools/checks/api.sh
}
test_sanitizer() {
  local preset=$1 compiler=()
  # Where it is there, clang builds every sanitizer: in half the time that GCC takes.
  if command -v clang++-22 >/dev/null; then
    compiler=(-DCMAKE_CXX_COMPILER=clang++-22)
  elif [ "$preset" = rtsan ]; then
    skip "RealtimeSanitizer needs clang++-22, which this distribution does not carry"
    return 0
  fi
  # What compiles gives way as the other rows do: tests that are starved of the processor for long run out of time.
  (give_way && build "$preset" patella_tests "${compiler[@]}") && ctest --preset "$preset" -j "$(nproc)"
}

# Tests that keep wall time (User-mode Linux, the page in a browser) sleep most of it. The release build's other tests run
# then, and give way to them. They compute: what compiles holds processors in the kernel, too long for an emulated loop.
give_way() { chrt --idle --pid 0 "$BASHPID" || true; }
row_of_release() {
  give_way
  part "style, and documentation of the API" check_style &&
    beside_others "tests: release" -j "$(($(nproc) + 1))" -LE wall_time &&
    part "fuzz: what is in the tree, and some seconds of chance" tests/fuzz/run.sh short &&
    part "lint" tools/checks/tidy.py build/release
}
# Scenarios of the board count instructions, and do not mind what runs beside them. Of the unit tests those run there that
# depend on processor or libraries: byte order, the heap's symbols, the lines.
row_of_board() {
  give_way
  part "board: the emulated arm64, and tests under user emulation" run_board allocation_counter_test can_test gpiod_pins_test
}
# Some tests of sanitizers keep wall time, too.
row_of_sanitizers() {
  part "sanitizers: address and undefined behaviour" test_sanitizer asan &&
    part "sanitizers: thread" test_sanitizer tsan &&
    part "sanitizers: realtime" test_sanitizer rtsan
}
rows=()
# Rows have process groups of their own, so that they end with this.
start() {
  set -m
  "$1" &
  rows+=($!)
  set +m
}
trap 'kill -- "${rows[@]/#/-}" 2>/dev/null' EXIT

failed=0
start row_of_release
beside_others "tests: release, in wall time and in User-mode Linux" -j "$(nproc)" "${again[@]}" -L wall_time || failed=$?
start row_of_board
start row_of_sanitizers
others=0
for row in "${rows[@]}"; do
  wait "$row" || others=$?
done
trap - EXIT

if [ -s "$logs/failed" ]; then
  part "tests that failed beside others, alone" \
    ctest --preset release -j 1 "${again[@]}" -R "^($(paste -sd '|' "$logs/failed"))\$" || failed=$?
fi
[ "$others" -eq 0 ] || failed=$others

headline "end; seconds of parts that ran side by side"
sort -rn "$logs/times"
[ "$failed" -eq 0 ] || { printf '\n== FAILED\n'; exit "$failed"; }
if grep -h ^SKIPPED "$logs"/*.log >"$logs/skipped"; then
  printf '\n== %s\n' "passed, but for $(wc -l <"$logs/skipped") parts that were SKIPPED"
  sed 's/^/  /' "$logs/skipped"
fi
