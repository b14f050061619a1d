# The emergency stop as a real interrupt and as a level on the board's PL061, the drive-enable and heartbeat lines read
# back through the controller.
#
# First a press so short that it is over before the next tick looks at the level: only its edges can stop the loop.
# In a second run it is pressed and held.
# board: kernel=rt time=counted limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config <"$PATELLA_SOURCE/tests/board/qemu/gpio.toml"
mount -t debugfs debugfs /sys/kernel/debug

# Levels of the lines that the loop has requested, as the controller reports them: "out hi", "out lo", "in  lo".
line() {
  sed -n "s/^ gpio-$((first_line + $1)) .*) \(in \|out\) *\(hi\|lo\).*/\2/p" /sys/kernel/debug/gpio
}
interrupts() {
  awk '/patella/ { sum += $2 } END { print sum + 0 }' /proc/interrupts
}

# press REQUEST NAME
press() {
  start_rig vcan0
  {
    sleep 1.7
    first_line=$(sed -n 's/^gpiochip0: GPIOs \([0-9]*\)-.*/\1/p' /sys/kernel/debug/gpio)
    cat /sys/kernel/debug/gpio
    highs=0 lows=0
    for sample in 1 2 3 4 5 6 7 8 9 10 11 12; do
      case $(line 2) in hi) highs=$((highs + 1)) ;; lo) lows=$((lows + 1)) ;; esac
      # A little longer each time: whatever a sample takes, some meet each level of a line that toggles every tick.
      sleep "0.00$((30 + sample * 2))"
    done
    echo "$highs $lows $(line 1) $(interrupts)" >/run/work/before
    ask_host $1
    sleep 0.7
    echo "$(line 1) $(interrupts)" >/run/work/after
  } &
  watcher=$!
  run_loop vcan0 3 --require-rt
  wait "$watcher"
  read -r highs lows enable_before irq_before </run/work/before
  read -r enable_after irq_after </run/work/after
  expect "heartbeat samples high" "$highs" -ge 1
  expect "heartbeat samples low" "$lows" -ge 1
  expect "drive enable while torque flows" "$enable_before" = hi
  expect "drive enable after the stop" "$enable_after" = lo
  expect "interrupts of the line by the press" $((irq_after - irq_before)) -ge 1
  expect "exit status of the loop" "$status" -eq 3
  require final_state = fault
  require stops -eq 1
  require overruns -eq 0
  grep -A3 '"latched"' "$run/summary.json" | grep -q '"emergency_stop"' ||
    fail "summary.json does not name emergency_stop"
  stop_rig
  # From the first tick with the fault on, torque must be zero within two ticks and stay so.
  awk -F, -v kind="$2" '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    !stopped && int($column["faults"]) % 2 { stopped = NR }
    !stopped { if ($column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0) flowed = 1 }
    stopped && ($column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0) { last = NR }
    END {
      if (!stopped || !flowed) { print "FAILED: ticks.csv: no torque, or no emergency stop"; exit 1 }
      ticks = last ? last - stopped + 1 : 0
      print "emergency stop by " kind ": torque command zero " ticks " ticks after the tick that saw it"
      if (ticks > 2) { print "FAILED: expected at most 2"; exit 1 }
    }' "$run/ticks.csv" || failed=1
  mv "$run" "$PATELLA_ARTEFACTS/$2"
}

press "line 3 1 0" interrupt
press "line 3 1" level
finish
