#!/bin/sh
# First process of the guest. `patella_job`, from the kernel's command line, is the folder shared with run.sh;
# the status file is written last, so that whatever goes wrong before leaves none.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/run LC_ALL=C.UTF-8
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t tmpfs tmpfs /run
mount -t hostfs none "$patella_job" -o "$patella_job"
. "$patella_job/settings"
mount -t hostfs none "$PATELLA_ARTEFACTS" -o "$PATELLA_ARTEFACTS"
mkdir /run/work && cd /run/work && export TMPDIR=/run/work
ulimit -l unlimited -r 99 2>/dev/null

status=98
if "$PATELLA_UML_TOOLS/load_module" "$modules/net/can/can.ko" "$modules/net/can/can-raw.ko" \
    "$modules/drivers/net/can/dev/can-dev.ko" "$modules/drivers/net/can/vcan.ko" &&
  /usr/sbin/ip link add dev vcan0 type vcan && /usr/sbin/ip link set dev vcan0 mtu 72 up; then
  sh "$@"
  status=$?
else
  echo "init.sh: vcan0 could not be brought up" >&2
fi
dmesg >"$PATELLA_ARTEFACTS/kernel.log" 2>/dev/null
echo "$status" >"$patella_job/status"
sync
echo o >/proc/sysrq-trigger
while :; do sleep 1; done
