#!/bin/sh
# The harness itself: vcan0 carries a frame and an error frame between two processes, CAN FD is on.
set -eu
candump -L -n 3 -T 5000 "vcan0,0:0,#FFFFFFFF" >seen.txt &
candump_pid=$!
sleep 0.3
cansend vcan0 123#11223344
cansend vcan0 124##3AABB
cansend vcan0 20000040#0000000000000000
wait "$candump_pid"
cat seen.txt
grep -q 'vcan0 123#11223344$' seen.txt
grep -q 'vcan0 124##[0-9A-F]AABB$' seen.txt
grep -q 'vcan0 20000040#0000000000000000' seen.txt
cp seen.txt "$PATELLA_ARTEFACTS/"
# Asked for by the test of run.sh's own status reporting.
exit "${1:-0}"
