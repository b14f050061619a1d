# The loop's wake-up latency beside cyclictest's, in turns in the same run, at the same priority, on the same processor and
# under the same load: the rig, at a lower priority. Both wake each 1.004 ms, so that the rig's frames, one a millisecond, meet
# every phase of them; at a fixed phase the figures would say where that happens to lie. jitter.sh [TICKS [PAIRS]]: of a turn,
# and how many pairs of them.
# board: kernel=rt time=counted limit=1500
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
ticks=${1:-1000} pairs=${2:-2}
make_vcan
make_config </dev/null
rig_config=$config_dir/rig.toml
sed 's/^priority = .*/priority = 40/' "$config" >"$rig_config"
period_us=1004
rate_Hz=$(awk -v period="$period_us" 'BEGIN { printf "%.10f", 1e6 / period }')
seconds=$(awk -v ticks="$ticks" -v period="$period_us" 'BEGIN { printf "%.6f", 1e-6 * ticks * period }')
: >/run/work/loop
: >/run/work/cyclictest
pair=0
while [ "$pair" -lt "$pairs" ]; do
  start_rig vcan0
  run_loop vcan0 "$seconds" --rate "$rate_Hz" --require-rt
  expect "exit status of the loop" "$status" -eq 0
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next } { print $column["wakeup_us"], 1 }' \
    "$run/ticks.csv" >>/run/work/loop
  cyclictest -q -N -m -t 1 -p 80 -i "$period_us" -h 50000 -l "$ticks" >/run/work/histogram
  # Leading zeros would be taken for octal numbers.
  sed 's/ 0*\([0-9]\)/ \1/g; s/^0*\([0-9]\)/\1/' /run/work/histogram |
    awk '/^# Histogram Overflows:/ && $4 > 0 { print 50, $4 } /^[0-9]/ && $2 > 0 { print $1 / 1000, $2 }' >>/run/work/cyclictest
  stop_rig
  pair=$((pair + 1))
done

# quantile FILE FRACTION
quantile() {
  total=$(awk '{ sum += $2 } END { print sum }' "$1")
  sort -n "$1" | awk -v wanted="$2" -v total="$total" '{ seen += $2; if (seen >= wanted * total) { print $1; exit } }'
}
for program in loop cyclictest; do
  expect "wake-ups of $program" "$(awk '{ sum += $2 } END { print sum + 0 }' "/run/work/$program")" -eq $((ticks * pairs))
  echo "$program: p50 $(quantile "/run/work/$program" 0.5), p99 $(quantile "/run/work/$program" 0.99)," \
    "p99.9 $(quantile "/run/work/$program" 0.999), max $(quantile "/run/work/$program" 1) µs"
done
awk -v loop="$(quantile /run/work/loop 0.999)" -v cyclictest="$(quantile /run/work/cyclictest 0.999)" '
  BEGIN { printf "p99.9 of the loop is %.2f times that of cyclictest\n", loop / cyclictest; exit loop > 1.1 * cyclictest }' ||
  fail "p99.9 of the loop is $(quantile /run/work/loop 0.999) µs, expected at most 1.1 times that of cyclictest"
cp /run/work/loop /run/work/cyclictest "$PATELLA_ARTEFACTS/"
finish
