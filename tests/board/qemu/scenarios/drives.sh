# Loop and rig as two processes over vcan at 1 kHz, on two drives of one kind: nothing is lost, the loop thread neither
# allocates nor faults a page, and the leg follows as it does on the rig's own drive. drives.sh mit|odrive|cia402 [SECONDS]
# board: kernel=rt time=counted limit=3000
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
kind=$1 seconds=${2:-3}
config_dir=$PATELLA_SOURCE/tools/bench/faults/rigs
config=$config_dir/board.toml
shipped=$PATELLA_SOURCE/firmware_app/config
[ -f "$config_dir/$kind.toml" ] || { fail "kind of drive '$kind', expected mit, odrive or cia402"; finish; }

# The kind's configuration, as make_config has it.
make_drives() {
  sed 's/^enable_at_s.*/enable_at_s = 1.5/; s/^kind = "human"/kind = "none"/' "$config_dir/$kind.toml" >"$config"
}
# The same leg and motion on the rig's own drive: other map, no drive models.
make_own_drive() {
  make_drives
  sed -i -e "s#^map = .*#map = \"$shipped/can/patella.toml\"#" -e '/^\[\[rig.drive_model\]\]/,/^\[rig.emg\]/ { /^\[rig.emg\]/!d }' "$config"
}
# Largest of the joints' tracking errors.
tracking_error() {
  sed -n '/"tracking_rms_rad": *\[/,/\]/p' "$run/summary.json" | tr -c '0-9.e-' '\n' |
    awk '/^[0-9]/ { if ($1 + 0 > most) most = $1 + 0 } END { printf "%.6f\n", most }'
}
follow() {
  start_rig vcan0
  run_loop vcan0 "$seconds" --require-rt
  stop_rig
  require_perfect
  require ticks -eq $((seconds * 1000))
  require preempt_rt = true
}

make_vcan
make_own_drive
follow
own=$(tracking_error)
make_drives
follow
drives=$(tracking_error)
echo "tracking error: $drives rad on drives of kind $kind, $own rad on the rig's own drive"
# Torque in whole steps and velocity from positions cost a little.
awk -v a="$drives" -v b="$own" 'BEGIN { exit !(b > 0 && a > 0 && a <= 1.1 * b) }' ||
  fail "tracking error $drives rad, expected at most 1.1 times $own"
finish
