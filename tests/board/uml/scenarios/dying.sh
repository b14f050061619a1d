#!/bin/sh
# The loop's process ends by SIGTERM, SIGSEGV and SIGKILL while torque flows, on drives of each kind. Asked to end, and
# dying of a fault of its own, it leaves every drive with zero torque and out. Killed, it says nothing more, and the
# drives' own watchdogs take the torque away. dying.sh PATELLA PATELLA_RIG CONFIG SHIPPED_CONFIGURATIONS mit|odrive|cia402
set -eu
shipped=$4 kind=$5
template=$3
. "$(dirname "$0")/with_rig.sh"
here=/run/work/dying
mkdir -p "$here"

# The shipped map of a kind, at 100 Hz, with times as for no motor and watchdogs of 0.9 s.
make_map() {
  sed -e "s#\"\([a-z0-9_]*\.\(dbc\|eds\)\)\"#\"$shipped/can/\1\"#" \
    -e 's/^\(encoder\|emg\)_period_s = .*/\1_period_s = 0.01/' \
    -e 's/^\(encoder\|drive\|emg\)_timeout_s = .*/\1_timeout_s = 1.0/' -e 's/^tolerated_bad_frames = .*/tolerated_bad_frames = 100/' \
    -e 's/^heartbeat_period_s = .*/heartbeat_period_s = 0.01/' -e 's/^heartbeat_timeout_s = .*/heartbeat_timeout_s = 0.9/' \
    -e 's/^node_heartbeat_timeout_s = .*/node_heartbeat_timeout_s = 1.0/' -e 's/^enter_timeout_s = .*/enter_timeout_s = 2.0/' \
    "$shipped/can/$1.toml" >"$here/map.toml"
}
range() { printf '\n[[range]]\nmessage = "%s"\nsignal = "%s"\nminimum = -%s\nmaximum = %s\n' "$1" "$2" "$3" "$3" >>"$here/map.toml"; }
make_run() {
  sed -e "s#MODELS#$shipped/models#" -e "s#MAP#$here/map.toml#" "$template" >"$here/run.toml"
  for node in 1 2; do
    printf '\n[[rig.drive_model]]\nkind = "%s"\nid = %s\ntorque_limit_Nm = 144\n%s\n' "$1" "$node" "$2" >>"$here/run.toml"
  done
}

# What the drives heard last: a mark for each frame to a drive, 0 without and T with torque, L to leave. Torque of 6071h is
# in the last two bytes; in MIT mode raw 2048 of the last twelve bits is none, and FF..FD leaves; of an ODrive it is a float,
# and state 1 leaves.
marks() {
  case $1 in
    mit) grep -E ' 00[12]#' | sed -e 's/.*#FFFFFFFFFFFFFFFD/L/' -e 's/.*#FFFFFFFFFFFFFFFC/E/' -e 's/.*800$/0/' -e 's/.*#.*/T/' ;;
    odrive) grep -E ' 0(2|4)(E|7)#' | sed -e 's/.*7#01000000/L/' -e 's/.*7#08000000/E/' -e 's/.*E#00000000/0/' -e 's/.*#.*/T/' ;;
    cia402) grep -E ' 20[12]#' | sed -e 's/.*#....0000$/0/' -e 's/.*#.*/T/' ;;
  esac
}

# One loop that ends by the signal; fails where torque has not flowed before.
attempt() {
  start_rig
  candump -L "$PATELLA_CAN_INTERFACE" >"$here/heard.log" &
  candump_pid=$!
  rm -rf "$run"
  "$patella" run --config "$config" --backend "can:$PATELLA_CAN_INTERFACE" --duration 60 --out "$run" >"$PATELLA_ARTEFACTS/loop.txt" 2>&1 &
  loop_pid=$!
  waited=0
  while [ "$waited" -lt 60 ] && ! grep -qE 'state=(active|fault)' "$run/events.log" 2>/dev/null; do
    sleep 0.5
    waited=$((waited + 1))
  done
  sleep 1.5
  kill "-$1" "$loop_pid" || true
  wait "$loop_pid" || true
  sleep 2
  kill -INT "$candump_pid" && wait "$candump_pid" || true
  stop_rig || true
  tail -n 60 "$here/heard.log" >"$PATELLA_ARTEFACTS/$kind-$1.log"
  # Three frames to each of two drives: the exit's second round. A tick under way may come between it and the first.
  last=$(marks "$kind" <"$here/heard.log" | tail -n 6 | tr -d '\n')
  trips=$(sed -n 's/.* \([0-9]*\) watchdog trips.*/\1/p' "$PATELLA_ARTEFACTS/rig.txt")
  torque=$(marks "$kind" <"$here/heard.log" | grep -c T || true)
  echo "$kind $1: the last frames $last, $torque with torque, $trips watchdog trips"
  [ "$torque" -gt 50 ] && ! grep -q 'state=fault' "$run/events.log"
}

# A host that others use as well may stand still for longer than a loop bears: that says nothing of how one dies.
dies_by() {
  tries=1
  until attempt "$1"; do
    [ "$tries" -lt 3 ] || { cat "$PATELLA_ARTEFACTS/loop.txt" "$run/events.log" >&2; echo "$kind: torque never flowed" >&2; failed=1; return 0; }
    tries=$((tries + 1))
  done
  if [ "$1" = KILL ]; then
    case $last in *L*) echo "$kind: a killed process told the drives to leave" >&2; failed=1 ;; esac
    [ "$trips" -ge 2 ] || { echo "$kind: $trips drives took their torque away by themselves, expected 2" >&2; failed=1; }
  else
    case $last in *T*) echo "$kind $1: torque among the last frames" >&2; failed=1 ;; esac
    [ "$trips" -eq 0 ] || { echo "$kind $1: drives were left with torque until their watchdog" >&2; failed=1; }
  fi
}

case $kind in
  mit)
    make_map mit_mode
    for motor in 1 2; do
      for message in "Motor${motor}Command:" "MotorReply:$motor"; do
        range "${message%:*}" "Position${message#*:}" 12.5
        range "${message%:*}" "Velocity${message#*:}" 8
        range "${message%:*}" "Torque${message#*:}" 144
      done
    done
    make_run mit 'master_id = 0
position_range_rad = 12.5
velocity_range_rad_s = 8
torque_range_Nm = 144
watchdog_s = 0.9' ;;
  odrive)
    make_map odrive_cansimple
    make_run odrive 'watchdog_s = 0.9' ;;
  cia402)
    make_map cia402
    make_run cia402 'rated_torque_Nm = 0.5
gear = 100
counts_per_turn = 16384
watchdog_s = 0.9' ;;
esac
config=$here/run.toml
# The programs are read from the host once, so that the operator does not raise enable before the first loop is ready.
"$patella" check --config "$config" --backend sim >/dev/null
"$patella_rig" --version >/dev/null
for signal in TERM SEGV KILL; do
  dies_by "$signal"
done
exit "$failed"
