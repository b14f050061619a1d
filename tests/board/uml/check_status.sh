#!/bin/sh
# run.sh reports what happened in the guest: a scenario's own status, and the lack of one.
here=$(cd "$(dirname "$0")" && pwd)
expect() {
  wanted=$1; shift
  "$here/run.sh" "$@" >/dev/null 2>&1
  found=$?
  if [ "$found" = 77 ]; then
    "$here/run.sh" "$@"
    exit 77
  fi
  [ "$found" = "$wanted" ] || { echo "run.sh $*: status $found, expected $wanted" >&2; exit 1; }
}
expect 0 kernel_can
expect 5 kernel_can -- 5
expect 99 ends_without_status
expect 99 never_ends --time-limit 5
expect 2 no_such_scenario
