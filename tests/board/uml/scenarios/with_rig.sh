# Sourced by the scenarios that put the loop and the rig on vcan0 as two processes.
# Arguments of the scenario: PATELLA PATELLA_RIG CONFIG
patella=$1 patella_rig=$2 config=$3
run=$PATELLA_ARTEFACTS/run

start_rig() {
  "$patella_rig" --config "$config" "can:$PATELLA_CAN_INTERFACE" >"$PATELLA_ARTEFACTS/rig.txt" 2>&1 &
  rig_pid=$!
  trap 'kill "$rig_pid" 2>/dev/null || true' EXIT
  sleep 0.5
  kill -0 "$rig_pid" || { cat "$PATELLA_ARTEFACTS/rig.txt"; exit 1; }
}

run_loop() {
  rm -rf "$run"
  "$patella" run --config "$config" --backend "can:$PATELLA_CAN_INTERFACE" --duration "$1" --out "$run"
}

stop_rig() {
  kill -TERM "$rig_pid"
  wait "$rig_pid"
}

# Value of a number or word that appears once in the run's summary.
field() {
  sed -n "s/^ *\"$1\": *\"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}$/\1/p" "$run/summary.json" | head -n 1
}

# require NAME TEST VALUE: compares as test(1) does.
require() {
  found=$(field "$1")
  if ! [ "${found:-absent}" "$2" "$3" ]; then
    echo "summary.json: $1 is ${found:-absent}, expected $2 $3" >&2
    failed=1
  fi
}
failed=0
