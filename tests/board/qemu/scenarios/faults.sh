# One fault of each kind while torque flows, injected by script: in the rig over vcan, or on the loop's own host. Each is
# answered by a stop that names it, with torque zero from the tick that sees it on; what owes no stop is told of.
# faults.sh [KIND...]
# board: kernel=rt time=counted limit=2400
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
make_vcan
make_config </dev/null
sed -i 's/^enable_at_s.*/enable_at_s = 1.1/' "$config"
wanted=" $* "
script=/run/work/faults.toml

# fault KIND[:NOTE] SIDE EXPECTED [PARAMETER...]: SIDE is rig or loop; EXPECTED a pattern of the fault's name, or of the warning's
# where it begins with a minus, or = where the loop must not notice.
fault() {
  kind=$1 side=$2 expected=$3
  shift 3
  [ "$wanted" = "  " ] || case $wanted in *" $kind "*) ;; *) return 0 ;; esac
  # Seconds since the rig's start, or since the loop's, which comes later.
  [ "$side" = rig ] && at=1.6 || at=1.0
  { echo "[[fault]]"; echo "kind = \"${kind%%:*}\""; echo "time_s = $at"; printf '%s\n' "$@"; } >"$script"
  rig_faults= loop_faults=
  [ "$side" = rig ] && rig_faults="--faults $script" || loop_faults="--faults $script"
  # shellcheck disable=SC2086
  patella-rig --config "$config" $rig_faults can:vcan0 >"$PATELLA_ARTEFACTS/rig.txt" 2>&1 &
  rig_pid=$!
  sleep 0.4
  # shellcheck disable=SC2086
  run_loop vcan0 1.9 $loop_faults >/dev/null
  kill -TERM "$rig_pid" 2>/dev/null
  wait "$rig_pid" || { cat "$PATELLA_ARTEFACTS/rig.txt"; fail "$kind: the rig ended badly"; }
  ip link set vcan0 up
  case $expected in
    =)
      require final_state = active
      require stops -eq 0
      require overruns -eq 0
      require minor_page_faults -eq 0
      require major_page_faults -eq 0
      echo "$kind: no page fault, no overrun, torque goes on"
      ;;
    -*)
      require final_state = active
      require stops -eq 0
      grep -qE "\"(${expected#-})\"" "$run/summary.json" || fail "$kind: summary.json does not name ${expected#-}"
      echo "$kind: told of as ${expected#-}, torque goes on"
      ;;
    *)
      expect "$kind: exit status of the loop" "$status" -eq 3
      raised=$(grep -m 1 raised= "$run/events.log" | grep -oE 'raised=[a-z_]+' | cut -d= -f2 | tr '\n' ' ')
      echo "$raised" | grep -qE "$expected" || fail "$kind: the first fault is ${raised:-none }, expected $expected"
      require final_state = fault
      [ "$kind" != interface_down ] || grep -q '"bus_off"' "$run/summary.json" || fail "$kind: summary.json does not name bus_off"
      awk -F, -v kind="$kind" -v raised="$raised" '
        NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
        { torque = $column["tau_cmd1_Nm"] != 0 || $column["tau_cmd2_Nm"] != 0 }
        torque { flowed = 1 }
        flowed && !stopped && $column["faults"] != 0 { stopped = NR; time_s = $column["t_s"] }
        stopped && torque { ++after }
        END {
          if (!flowed || !stopped) { print "FAILED: " kind ": no torque, or no fault"; exit 1 }
          print kind ": " raised "at " time_s " s, torque commanded in " after + 0 " ticks from then on"
          exit after > 0
        }' "$run/ticks.csv" || failed=1
      ;;
  esac
}

for_long='duration_s = 1.0'
fault lost_frames rig encoder_stale 'channel = "encoder1"' "$for_long"
fault delayed_frames rig encoder_stale 'channel = "encoder1"' 'delay_s = 0.2' "$for_long"
fault duplicated_frames rig frame_sequence 'channel = "encoder2"' "$for_long"
fault reordered_frames rig frame_sequence 'channel = "encoder2"' "$for_long"
fault flipped_bits rig frame_corrupt 'channel = "drive"' "$for_long"
fault forged_frames rig 'frame_sequence|encoder_in|encoder_imp' 'channel = "encoder1"' 'value = -1.0' "$for_long"
fault encoder_jump rig encoder_implausible 'channel = "encoder2"' 'offset_rad = 0.5' "$for_long"
fault encoder_freeze rig encoder_inconsistent 'channel = "encoder1"' 'with_velocity = false' "$for_long"
fault encoder_drift rig encoder_inconsistent 'channel = "encoder1"' 'rate_rad_s = 1.0' "$for_long"
fault encoder_wrap rig encoder_implausible 'channel = "encoder2"' "$for_long"
fault emg_saturation rig emg_saturated 'channel = "emg1"' "$for_long"
fault emg_disconnection rig emg_electrode_off 'channel = "emg3"' "$for_long"
fault emg_hum rig emg_hum 'channel = "emg2"' 'amplitude_mV = 1.0' "$for_long"
fault drive_not_following rig 'drive_not_following|following|model' 'channel = "drive1"' 'gain = -1.0' "$for_long"
fault drive_over_torque rig drive_not_following 'channel = "drive1"' 'extra_Nm = 60' "$for_long"
fault bus_off rig bus_off 'duration_s = 0.1'
# The kernel waits for its readers before it takes an interface down; the rig's silence may be seen first.
fault interface_down rig 'bus_off|encoder_stale' 'duration_s = 0.1'
fault rig_stall rig encoder_stale 'duration_s = 0.1'
fault peer_restart rig encoder_stale 'duration_s = 0.1'
fault loop_stall loop 'watchdog|overrun' 'duration_s = 0.1'
fault emergency_stop loop emergency_stop 'duration_s = 0.1'
fault gpio_bounce loop emergency_stop 'duration_s = 0.02'
fault clock_step loop -clock_stepped 'step_s = 10' 'duration_s = 0.5'
fault memory_pressure loop = 'size_MB = 48' 'duration_s = 0.5'
fault disk_full loop -recording_failed 'duration_s = 0.3'

# Faults that come and go, faults that strike within a tick, and another commander.
fault drive_over_torque:now_and_then rig 'drive_(not_following|over_torque)' 'channel = "drive1"' 'extra_Nm = 60' \
  'cycle_s = 0.02' 'duty = 0.75' "$for_long"
fault drive_over_torque:seldom rig 'drive_(not_following|over_torque)' 'channel = "drive1"' 'extra_Nm = 260' \
  'cycle_s = 0.1' 'duty = 0.05' "$for_long"
fault lost_frames:now_and_then rig frame_sequence 'channel = "encoder1"' 'cycle_s = 0.004' 'duty = 0.5' "$for_long"
fault flipped_bits:now_and_then rig frame_corrupt 'channel = "drive"' 'cycle_s = 0.01' 'duty = 0.3' "$for_long"
fault encoder_jump:now_and_then rig 'encoder_im|encoder_in' 'channel = "encoder2"' 'offset_rad = 0.5' 'cycle_s = 0.01' \
  'duty = 0.3' "$for_long"
fault emg_saturation:now_and_then rig emg_saturated 'channel = "emg1"' 'cycle_s = 0.01' 'duty = 0.5' "$for_long"
fault forged_frames:command rig foreign_command 'channel = "command"' 'value = 5.0' 'duration_s = 0.01'
fault loop_stall:before_send loop 'command_late|watchdog' 'duration_s = 0.3' 'stage = "encode"'
fault loop_stall:after_send loop 'watchdog|overrun' 'duration_s = 0.3' 'stage = "lines out"'
fault loop_stall:overload loop overrun 'cycle_s = 0.007' 'duty = 0.6' "$for_long"
finish
