#!/usr/bin/env bash
# Our set-up and a run of the loop on CANopen slaves of another author (npm canopen), and our data sheet in that author's
# reader and back. The log of what went over the bus is left for check_with_tshark.sh.
#
#   foreign_slave.sh FOREIGN_RUN SOURCE_FOLDER NPM_FOLDER LOG
set -euo pipefail
run=$1 source=$2 npm=$3 log=$4
here=$source/tests/integration/foreign
rm -f "$log"
"$source/tools/npm_packages.sh" "$source/tests/support/npm" "$npm" "no CANopen slave of another author was set up"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

sheet=$source/firmware_app/config/can/cia402.eds
node "$here/sheet.cjs" "$npm" "$sheet" "$folder/written.eds"

# The configuration of this folder with absolute paths; the drives' sheet is the one that the package wrote.
sed "s#\"../../../#\"$source/#; s#\"bus.toml\"#\"$folder/bus.toml\"#" "$here/run.toml" >"$folder/run.toml"
sed "s#\"../../../firmware_app/config/can/cia402.eds\"#\"$folder/written.eds\"#; s#\"../../../#\"$source/#" "$here/bus.toml" \
  >"$folder/bus.toml"

failed=0
# Hip at -1.2 rad and knee at -0.4 rad: counts of 16384 a turn behind a gear of 100.
"$run" "$folder/run.toml" "$folder/frames.log" node "$here/slave.cjs" "$npm" "$sheet" 1:-312910 2:-104303 2>"$folder/slaves" || failed=1
cat "$folder/slaves"
# Both were enabled, got torque, and were left disabled, pre-operational (127), in torque mode, with three objects mapped. The
# loop's heartbeat, which they watched, was not missed.
for node in 1 2; do
  grep -qE "^node=$node state=disabled enabled_once=true largest_per_mille=[1-9][0-9]* changes=[1-9][0-9]* heartbeat_timeouts=0 nmt=127 mode=10 mapped=3$" \
    "$folder/slaves" || { echo "FAILS  node $node is not as it should be left" && failed=1; }
done
cp "$folder/frames.log" "$log"
exit "$failed"
