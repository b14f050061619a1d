#!/usr/bin/env bash
# Installs the libraries into a prefix of its own, builds docs/examples against what stands there, and runs them.
#
#   examples.sh BUILD_DIR PATELLA VERSION SCRATCH
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
build=${1:?"usage: examples.sh BUILD_DIR PATELLA VERSION SCRATCH"}
patella=$(realpath "$2")
version=$3
scratch=$4
rm -rf "$scratch"
mkdir -p "$scratch"
scratch=$(cd "$scratch" && pwd)

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
# configure NAME CMAKELISTS...: a project of that text against the prefix; its output stands in NAME.log.
configure() {
  mkdir "$scratch/$1"
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(%s LANGUAGES CXX)\n%s\n' "$1" "$2" >"$scratch/$1/CMakeLists.txt"
  cmake -S "$scratch/$1" -B "$scratch/$1/build" -DCMAKE_PREFIX_PATH="$prefix" >"$scratch/$1.log" 2>&1
}

prefix=$scratch/prefix
cmake --install "$build" --prefix "$prefix" --component development >/dev/null
if grep -rlF "$source_dir" "$prefix" --include='*.cmake' --include='*.hpp'; then
  fail "the files above name the folder that they were built in"
fi

cmake -S "$source_dir/docs/examples" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" >"$scratch/configure.log" 2>&1 ||
  { cat "$scratch/configure.log"; fail "docs/examples cannot be configured"; }
cmake --build "$scratch/build" >"$scratch/build.log" 2>&1 || { cat "$scratch/build.log"; fail "docs/examples cannot be built"; }
for example in tick own_bus own_effect; do
  "$scratch/build/$example" || fail "docs/examples/$example.cpp ended with exit status $?"
done

# What the package must refuse, and what it must not ask for.
! configure future 'find_package(patella 2.0 REQUIRED)' || fail "version $version passed for 2.0"
grep -q "version: $version" "$scratch/future.log" || fail "no version $version: $(cat "$scratch/future.log")"
! configure unknown 'find_package(patella REQUIRED COMPONENTS legs)' || fail "a component that does not exist was found"
configure core_alone "find_package(patella $version EXACT REQUIRED COMPONENTS core)
if(TARGET patella::drivers OR PkgConfig_FOUND)
  message(FATAL_ERROR \"core brought the drivers along\")
endif()" || { cat "$scratch/core_alone.log"; fail "patella::core needs more than core"; }

run=$scratch/run
"$patella" run --config "$source_dir/firmware_app/config/adult.toml" --clock virtual --duration 2 --out "$run" >/dev/null
read=$(python3 "$source_dir/docs/examples/read_run.py" "$run")
echo "$read"
grep -q "^patella $version: 2000 ticks, [1-9][0-9]* of them active$" <<<"$read" || fail "read_run.py counts other ticks"
mkdir "$scratch/cut"
cp "$run"/summary.json "$scratch/cut"
head -c -20 "$run/ticks.csv" >"$scratch/cut/ticks.csv"
grep -q "^patella $version: 1999 ticks" <<<"$(python3 "$source_dir/docs/examples/read_run.py" "$scratch/cut" 2>&1)" ||
  fail "read_run.py does not read a run that was cut off"
! absent=$(python3 "$source_dir/docs/examples/read_run.py" "$scratch/absent" 2>&1) || fail "read_run.py took a folder that is not there"
[[ $absent == "read_run.py: $scratch/absent: "*"expected the folder of a run"* ]] || fail "read_run.py said: $absent"

# refused WORDS COMMAND...: ends with status 2 and these words, before anything is built or run.
refused() {
  local words=$1 said status=0
  shift
  said=$("$@" 2>&1) || status=$?
  { [ "$status" = 2 ] && [ "$said" = "$words" ]; } || fail "$* ended with $status: $said"
}
folders="a folder with emps, double_pendulum and passive_knee"
refused "tools/run.sh: --config: no value, expected a file" "$source_dir/tools/run.sh" --config
refused "tools/run.sh: --config: there is no file 'nofile.toml', expected a run configuration, from $source_dir" \
  "$source_dir/tools/run.sh" --config nofile.toml
refused "tools/run.sh: --out: '$run' is there already, expected a new or empty folder" "$source_dir/tools/run.sh" --out "$run"
refused "measured.sh: --data: missing, expected $folders" "$source_dir/tools/studies/measured/measured.sh" --out x
refused "measured.sh: --out: missing, expected a folder for the results" "$source_dir/tools/studies/measured/measured.sh" --data x
refused "measured.sh: --data: there is no folder '$run/emps', expected $folders" \
  "$source_dir/tools/studies/measured/measured.sh" --data "$run" --out x
refused "circle.sh: there is no file 'nofile', expected models of rigs, TOML" \
  "$source_dir/tools/studies/circle/circle.sh" --out x nofile

# The run's own summary says the same of these columns.
python3 - "$run/summary.json" "$read" <<'PY' || fail "read_run.py and summary.json differ"
import json, re, sys
own = json.load(open(sys.argv[1]))["tracking_rms_rad"]
read = [float(value) for value in re.findall(r"reference by ([0-9.]+)", sys.argv[2])]
sys.exit(0 if len(read) == len(own) == 2 and all(abs(a - b) <= 1e-4 for a, b in zip(own, read)) else f"{own} {read}")
PY
