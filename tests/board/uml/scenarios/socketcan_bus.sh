#!/bin/sh
# The SocketCAN backend against a real vcan0, bus-off included: socketcan_bus.sh SOCKETCAN_BUS_TEST
set -eu
command -v cansend >/dev/null || { echo "socketcan_bus.sh: no cansend (package can-utils)" >&2; exit 1; }
exec sh "$(dirname "$0")/run_test.sh" "$@"
