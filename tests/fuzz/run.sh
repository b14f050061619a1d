#!/usr/bin/env bash
# Builds the fuzz targets and runs each for so many seconds on the corpus in the tree and on the shipped files.
#
#   tests/fuzz/run.sh SECONDS [TARGET...]
#
# What is found stands in build/fuzz/findings; new inputs in build/fuzz/corpus. Exit status: 0 nothing found, or
# skipped (said loudly) where clang or its fuzzer runtime is absent; 1 something found.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:?usage: tests/fuzz/run.sh SECONDS [TARGET...]}
[[ $seconds =~ ^[0-9]+$ ]] || { echo "tests/fuzz/run.sh: '$seconds', expected whole seconds" >&2; exit 1; }
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(dbc candump safetensors configuration model tick)

probe=$(mktemp -d)
trap 'rm -rf "$probe"' EXIT
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' >"$probe/probe.cpp"
if ! command -v clang++-22 >/dev/null || ! clang++-22 -fsanitize=fuzzer,address "$probe/probe.cpp" -o "$probe/probe" 2>/dev/null; then
  echo "SKIPPED: fuzzing needs clang++-22 with its fuzzer runtime (libclang-rt-22-dev), which is not here"
  exit 0
fi

mkdir -p build
cmake --preset fuzz >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}"

seeds() {
  case $1 in
    dbc) echo drivers/can/*.dbc ;;
    model) echo firmware_app/config/models/*.toml ;;
    configuration) echo firmware_app/config/*.toml ;;
  esac
}
status=0
for target in "${targets[@]}"; do
  new=build/fuzz/corpus/$target
  findings=build/fuzz/findings/$target
  mkdir -p "$new" "$findings" "tests/fuzz/corpus/$target"
  for seed in $(seeds "$target"); do cp "$seed" "$new/"; done
  echo "== $target: $seconds s"
  log=build/fuzz/$target.log
  if build/fuzz/tests/fuzz/fuzz_"$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=16384 \
    -artifact_prefix="$findings/" -print_final_stats=1 "$new" "tests/fuzz/corpus/$target" >"$log" 2>&1; then
    grep -E 'stat::number_of_executed_units|cov:' "$log" | tail -2
  else
    tail -40 "$log"
    echo "FOUND: see $findings" >&2
    status=1
  fi
done
exit $status
