# Sourced by scenarios that run the loop and the rig as two processes. Without -e: a scenario goes on after a wrong
# figure, so that the log shows all of them, and ends with `finish`.
config_dir=$PATELLA_SOURCE/firmware_app/config
config=$config_dir/board.toml
failed=0

# The shell prefers its built-in commands, and that ip knows nothing of CAN.
ip() {
  /usr/sbin/ip "$@"
}

fail() {
  echo "FAILED: $*"
  failed=1
}

# expect WHAT FOUND TEST WANTED: compares as test(1) does.
expect() {
  [ "${2:-absent}" "$3" "$4" ] 2>/dev/null || fail "$1 is ${2:-absent}, expected $3 $4"
}

finish() {
  [ "$failed" = 0 ] && echo "scenario passed"
  exit "$failed"
}

# ask_host REQUEST...: something from outside the board, done when this returns. Without waiting, how much of the board's
# time went by until then would depend on how busy the host is.
ask_host() {
  echo "@host $*"
  host_call await answered
}

make_vcan() {
  modprobe can-raw
  modprobe vcan
  ip link add dev vcan0 type vcan
  ip link set dev vcan0 mtu 72 txqueuelen 10 up
}

# The demonstration, enabled only after the loop has had time to start, and without the person's push, whose many
# sinusoids take as long to compute as the rest of the rig. Further lines come from standard input.
make_config() {
  sed 's/^enable_at_s.*/enable_at_s = 1.5/; s/^kind = "human"/kind = "none"/' "$config_dir/adult.toml" >"$config"
  cat >>"$config"
}

# start_rig INTERFACE: with $rig_config, where the loop's is not for it.
start_rig() {
  patella-rig --config "${rig_config:-$config}" "can:$1" >"$PATELLA_ARTEFACTS/rig.txt" 2>&1 &
  rig_pid=$!
  sleep 0.5
  kill -0 "$rig_pid" || { cat "$PATELLA_ARTEFACTS/rig.txt"; fail "the rig did not start"; finish; }
}

stop_rig() {
  kill -TERM "$rig_pid"
  wait "$rig_pid"
  cat "$PATELLA_ARTEFACTS/rig.txt"
}

# run_loop INTERFACE SECONDS [OPTION...]: leaves its status in $status and its recording in $run.
run_loop() {
  interface=$1 duration=$2
  shift 2
  run=$PATELLA_ARTEFACTS/run
  rm -rf "$run"
  status=0
  patella run --config "$config" --backend "can:$interface" --duration "$duration" --out "$run" "$@" \
    >"$PATELLA_ARTEFACTS/loop.txt" 2>&1 || status=$?
  cat "$PATELLA_ARTEFACTS/loop.txt"
}

# field NAME: value of the first number or word of that name in the run's summary.
field() {
  sed -n "s/^ *\"$1\": *\"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}$/\1/p" "$run/summary.json" | head -n 1
}

# require NAME TEST WANTED: of the run's summary.
require() {
  expect "summary.json: $1" "$(field "$1")" "$2" "$3"
}

# Nothing was lost, late or corrupt on the way, and the loop thread kept every promise.
require_perfect() {
  expect "exit status of the loop" "$status" -eq 0
  for name in overruns missed_periods heap_allocations heap_frees minor_page_faults major_page_faults receive_dropped \
      send_failed error_frames bus_off stops ticks_dropped frames_dropped; do
    require "$name" -eq 0
  done
  for name in lost late corrupt; do
    expect "frames $name" "$(sed -n "s/^ *\"$name\": \([0-9]*\).*/\1/p" "$run/summary.json" |
      awk '{ sum += $1 } END { print sum + 0 }')" -eq 0
  done
  require final_state = active
}
