# can-utils on our bus: candump hears the commands that the loop recorded, and canplayer, playing the recording back,
# is a rig as good as the first.
# board: kernel=rt time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
payloads() {
  sed -n 's/^.* 080#\([0-9A-Fa-f]*\).*$/\1/p' "$1"
}

make_vcan
make_config </dev/null
start_rig vcan0
candump -L vcan0,080:7FF >"$PATELLA_ARTEFACTS/heard.log" &
candump_pid=$!
sleep 0.2
run_loop vcan0 2 --require-rt
sleep 0.1
kill -INT "$candump_pid"
wait "$candump_pid"
stop_rig
require_perfect
payloads "$PATELLA_ARTEFACTS/heard.log" >/run/work/heard
payloads "$run/frames.log" >/run/work/recorded
expect "commands recorded" "$(wc -l </run/work/recorded)" -ge 2000
cmp /run/work/heard /run/work/recorded || fail "candump heard other commands than the loop recorded"
mv "$run" "$PATELLA_ARTEFACTS/first"

# Everything but the loop's own commands, by somebody else's program at the recorded times.
grep -v ' 080#' "$PATELLA_ARTEFACTS/first/frames.log" >/run/work/rig.log
played=$(wc -l </run/work/rig.log)
{
  sleep 0.5
  chrt -f 79 canplayer -I /run/work/rig.log
} &
run_loop vcan0 3
wait $! || fail "canplayer could not play the recording"
require frames_received -eq "$played"
for name in corrupt repeated out_of_range; do
  expect "frames $name" "$(sed -n "s/^ *\"$name\": \([0-9]*\).*/\1/p" "$run/summary.json" |
    awk '{ sum += $1 } END { print sum + 0 }')" -eq 0
done
# The encoder's samples were the same, to the bit.
grep -v ' 080#' "$run/frames.log" | awk '{ print $3 }' >/run/work/again
awk '{ print $3 }' /run/work/rig.log | cmp - /run/work/again || fail "other frames arrived than were played"
finish
