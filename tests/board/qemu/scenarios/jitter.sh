# The loop's wake-up latency beside cyclictest's, in turns in the same run, at the same priority, on a processor that is
# kept for it. jitter.sh [SECONDS]: of a turn, two turns each.
# board: kernel=rt time=counted isolated=yes limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
seconds=${1:-1}
make_vcan
make_config </dev/null
sed -i 's/^cpus = .*/cpus = [1]/' "$config"
start_rig vcan0
: >/run/work/loop
: >/run/work/cyclictest
for turn in 1 2; do
  run_loop vcan0 "$seconds" --require-rt
  expect "exit status of the loop" "$status" -eq 0
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next } { print $column["wakeup_us"], 1 }' \
    "$run/ticks.csv" >>/run/work/loop
  cyclictest -q -N -m -t 1 -a 1 -p 80 -i 1000 -h 50000 -l $((seconds * 1000)) >/run/work/histogram
  # Leading zeros would be taken for octal numbers.
  sed 's/ 0*\([0-9]\)/ \1/g; s/^0*\([0-9]\)/\1/' /run/work/histogram |
    awk '/^# Histogram Overflows:/ && $4 > 0 { print 50, $4 } /^[0-9]/ && $2 > 0 { print $1 / 1000, $2 }' >>/run/work/cyclictest
done
stop_rig

# quantile FILE FRACTION
quantile() {
  total=$(awk '{ sum += $2 } END { print sum }' "$1")
  sort -n "$1" | awk -v wanted="$2" -v total="$total" '{ seen += $2; if (seen >= wanted * total) { print $1; exit } }'
}
for program in loop cyclictest; do
  expect "wake-ups of $program" "$(awk '{ sum += $2 } END { print sum + 0 }' "/run/work/$program")" -eq $((seconds * 2000))
  echo "$program: p50 $(quantile "/run/work/$program" 0.5), p99 $(quantile "/run/work/$program" 0.99)," \
    "p99.9 $(quantile "/run/work/$program" 0.999), max $(quantile "/run/work/$program" 1) µs"
done
awk -v loop="$(quantile /run/work/loop 0.999)" -v cyclictest="$(quantile /run/work/cyclictest 0.999)" '
  BEGIN { printf "p99.9 of the loop is %.2f times that of cyclictest\n", loop / cyclictest; exit loop > 50 }' ||
  fail "p99.9 of the loop is $(quantile /run/work/loop 0.999) µs, expected at most 50"
cp /run/work/loop /run/work/cyclictest "$PATELLA_ARTEFACTS/"
finish
