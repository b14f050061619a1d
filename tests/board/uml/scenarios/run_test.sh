#!/bin/sh
# Runs a doctest executable, given as argument, whose cases use $PATELLA_CAN_INTERFACE. A case that is skipped
# here was meant to run here: that is a failure.
set -eu
status=0
"$@" >run_test.txt 2>&1 || status=$?
cat run_test.txt
cp run_test.txt "$PATELLA_ARTEFACTS/"
[ "$status" = 0 ] || exit "$status"
grep -Eq 'test cases: +[1-9][0-9]* \| +[1-9][0-9]* passed \| +0 failed \| +0 skipped' run_test.txt || {
  echo "run_test.sh: no case ran, or some were skipped" >&2
  exit 1
}
