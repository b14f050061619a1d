#!/usr/bin/env bash
# Builds the fuzz targets and runs each on the corpus in the tree and on the shipped files.
#
#   tests/fuzz/run.sh SECONDS [TARGET...]    looks in each until that much processor time has gone into it
#   tests/fuzz/run.sh short [TARGET...]      the corpus in the tree, and some seconds of chance from a fixed seed
#   tests/fuzz/run.sh merge [TARGET...]      puts into the tree what has a name of its own there, and the fewest inputs
#                                            that pass every place in the code that all of them pass
#
# What is found stands in build/fuzz/findings; new inputs in build/fuzz/corpus. Exit status: 0 nothing found, or
# skipped (said loudly) where clang or its fuzzer runtime is absent; 1 something found.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:?usage: tests/fuzz/run.sh SECONDS|short|merge [TARGET...]}
[[ $seconds =~ ^([0-9]+|short|merge)$ ]] || { echo "tests/fuzz/run.sh: '$seconds', expected whole seconds, short or merge" >&2; exit 1; }
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(model configuration bus_map seal data_sheet tick dbc candump replay safetensors viewer)

probe=$(mktemp -d)
trap 'rm -rf "$probe"' EXIT
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' >"$probe/probe.cpp"
if ! command -v clang++-22 >/dev/null || ! clang++-22 -fsanitize=fuzzer,address "$probe/probe.cpp" -o "$probe/probe" 2>/dev/null; then
  echo "SKIPPED: fuzzing needs clang++-22 with its fuzzer runtime (libclang-rt-22-dev), which is not here"
  exit 0
fi

mkdir -p build
cmake --preset fuzz >build/configure-fuzz.log 2>&1 || { cat build/configure-fuzz.log; exit 1; }
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}"

seeds() {
  case $1 in
    dbc) echo drivers/can/*.dbc ;;
    data_sheet) echo firmware_app/config/can/*.eds ;;
    model) echo firmware_app/config/models/*.toml ;;
    configuration) echo firmware_app/config/*.toml ;;
    bus_map) echo firmware_app/config/can/*.toml ;;
  esac
}
# Longest input: a tick takes a tenth of a millisecond and a byte or twelve.
longest() { case $1 in tick) echo 1024 ;; seal) echo 64 ;; *) echo 16384 ;; esac; }
# Longest input that is kept in the tree.
kept() { case $1 in tick) echo 512 ;; seal) echo 64 ;; dbc) echo 1024 ;; *) echo 4096 ;; esac; }
# Limits of a run of two or three seconds.
short_runs() { case $1 in tick) echo 200 ;; viewer) echo 500 ;; model | configuration | bus_map) echo 2500 ;; *) echo 10000 ;; esac; }
# The words of the seeds and of what is in the tree, so that whole keys are put in and not letters.
words() {
  # shellcheck disable=SC2046
  cat $(seeds "$1") tests/fuzz/corpus/"$1"/* | grep -aoE '[A-Za-z_][A-Za-z_0-9]{2,30}' | sort -u | head -1000 |
    sed 's/.*/"&"/'
}
# Runs one target.
fuzz() {
  local target=$1
  local program=build/fuzz/tests/fuzz/fuzz_$target
  local tree=tests/fuzz/corpus/$target
  local new=build/fuzz/corpus/$target
  local findings=build/fuzz/findings/$target
  local log=build/fuzz/$target.log
  local limits dictionary started used executed found covered seed
  mkdir -p "$new" "$findings"
  if [ "$seconds" = merge ]; then
    mkdir "$probe/$target"
    find "$tree" -type f -regextype egrep -not -regex '.*/[0-9a-f]{40}' -exec cp {} "$probe/$target" \;
    "$program" -set_cover_merge=1 -use_counters=0 -max_len="$(kept "$target")" "$probe/$target" "$tree" "$new" >"$log" 2>&1 ||
      { tail -40 "$log"; return 1; }
    rm -rf "$tree"
    cp -r "$probe/$target" "$tree"
    echo "$target: $(find "$tree" -type f | wc -l) inputs, $(du -sb --apparent-size "$tree" | cut -f1) bytes"
    return 0
  fi
  if [ "$seconds" = short ]; then
    new=$probe/$target
    mkdir "$new"
    limits=(-seed=1 -runs="$(short_runs "$target")")
  else
    limits=(-max_total_time="$seconds")
  fi
  for seed in $(seeds "$target"); do cp "$seed" "$new/"; done
  dictionary=()
  if [ "$target" != tick ] && [ "$target" != seal ]; then
    words "$target" >build/fuzz/"$target".dict
    dictionary=(-dict=build/fuzz/"$target".dict)
  fi
  # A host with other work gives a run less than the time that passes: it goes on until it has had its time.
  started=$(date +%s) used=0 executed=0 found=no
  TIMEFORMAT='%U %S'
  while :; do
    [ "$seconds" = short ] || limits=(-max_total_time=$((seconds - used)))
    { time "$program" "${limits[@]}" -timeout=60 -rss_limit_mb=2048 -max_len="$(longest "$target")" \
      "${dictionary[@]}" -artifact_prefix="$findings/" -print_final_stats=1 "$new" "$tree" >"$log" 2>&1; } \
      2>"$probe/$target.time" || { found=yes; break; }
    used=$((used + $(tail -1 "$probe/$target.time" | awk '{ printf "%.0f", $1 + $2 }')))
    executed=$((executed + $(grep -aoE 'number_of_executed_units: *[0-9]+' "$log" | grep -oE '[0-9]+$')))
    [ "$seconds" != short ] && [ $((seconds - used)) -ge 5 ] || break
  done
  if [ "$found" = yes ]; then
    tail -40 "$log"
    echo "FOUND: $target, see $findings" >&2
    return 1
  fi
  covered=$(grep -aoE 'cov: [0-9]+ ft: [0-9]+' "$log" | tail -1)
  echo "$target: $executed executions in $(($(date +%s) - started)) s, processor $used s, $covered"
}

# As many at once as there are processors.
status=0 running=0
for target in "${targets[@]}"; do
  if [ "$running" -ge "$(nproc)" ]; then
    wait -n || status=1
    running=$((running - 1))
  fi
  fuzz "$target" &
  running=$((running + 1))
done
while [ "$running" -gt 0 ]; do
  wait -n || status=1
  running=$((running - 1))
done
exit $status
