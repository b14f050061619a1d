#!/bin/sh
# run.sh SCENARIO [--artefacts DIR] [--time-limit SECONDS] [-- ARGUMENT...]
#
# Runs scenarios/SCENARIO.sh under User-mode Linux: an unprivileged kernel with SocketCAN and vcan0, on the
# host's own file system (read-only but for the artefacts folder, which has the same path inside). Exits with
# the scenario's status; 77 where User-mode Linux cannot be had; 99 when the guest ended without a status.
#
# Environment: PATELLA_UML_TOOLS  folder of wide_xstate.so and load_module (made by the build)
#              PATELLA_UML_CACHE  folder to unpack the kernel package into
#              PATELLA_BIN_DIR    build tree, handed on to the scenario
set -eu

here=$(cd "$(dirname "$0")" && pwd)
usage() { sed -n '2,11s/^# \{0,1\}//p' "$0" >&2; exit 2; }
skip() {
  echo "==================================================================" >&2
  echo "SKIPPED, the SocketCAN path was NOT tested on a kernel: $*" >&2
  echo "==================================================================" >&2
  exit 77
}

[ $# -ge 1 ] || usage
scenario=$here/scenarios/$1.sh; shift
[ -f "$scenario" ] || { echo "run.sh: no scenario $scenario" >&2; exit 2; }
artefacts= time_limit=120
while [ $# -gt 0 ]; do
  case $1 in
    --artefacts) [ $# -ge 2 ] || usage; artefacts=$2; shift 2 ;;
    --time-limit) [ $# -ge 2 ] || usage; time_limit=$2; shift 2 ;;
    --) shift; break ;;
    *) usage ;;
  esac
done
: "${PATELLA_UML_TOOLS:?}" "${PATELLA_UML_CACHE:?}"

# The kernel: taken from Debian's package without installing it.
[ "$(uname -m)" = x86_64 ] || skip "User-mode Linux exists for amd64 only, this is $(uname -m)"
mkdir -p "$PATELLA_UML_CACHE"
cache=$(cd "$PATELLA_UML_CACHE" && pwd)
kernel=$cache/root/usr/bin/linux.uml
(
  flock 9
  [ -x "$kernel" ] && exit 0
  command -v apt-get >/dev/null && command -v dpkg >/dev/null || exit 1
  cd "$cache"
  ls user-mode-linux_*.deb >/dev/null 2>&1 || apt-get download -q user-mode-linux >&2 || exit 1
  rm -rf unpacked && dpkg -x user-mode-linux_*.deb unpacked && rm -rf root && mv unpacked root
) 9>"$cache/lock" || skip "package user-mode-linux could not be downloaded and unpacked"
[ -x /usr/sbin/ip ] || skip "no /usr/sbin/ip (package iproute2)"

# Files in and out of the guest.
job=$(mktemp -d "$cache/job.XXXXXX")
trap 'rm -rf "$job"' EXIT
[ -n "$artefacts" ] || artefacts=$job/artefacts
mkdir -p "$artefacts"
artefacts=$(cd "$artefacts" && pwd)
quote() { printf "'%s' " "$(printf %s "$1" | sed "s/'/'\\\\''/g")"; }
{
  for name in PATELLA_BIN_DIR PATELLA_UML_TOOLS; do
    eval "value=\${$name:-}"
    echo "export $name=$(quote "$value")"
  done
  echo "export PATELLA_ARTEFACTS=$(quote "$artefacts") PATELLA_CAN_INTERFACE=vcan0"
  echo "modules=$(quote "$(echo "$cache"/root/usr/lib/uml/modules/*/kernel)")"
  printf 'set -- '
  for argument in "$scenario" "$@"; do quote "$argument"; done
  echo
} >"$job/settings"

# The guest's memory is a file; a container's /dev/shm may be too small for it.
memory_mb=384
shm_mb=$(df -m --output=avail /dev/shm 2>/dev/null | tail -n 1 || true)
if [ "${shm_mb:-0}" -gt "$memory_mb" ]; then memory_dir=/dev/shm; else memory_dir=$job; fi

status=0
TMPDIR=$memory_dir LD_PRELOAD=$PATELLA_UML_TOOLS/wide_xstate.so \
  timeout --kill-after=10 "$time_limit" "$kernel" mem=${memory_mb}M uml_dir="$job/" \
  rootfstype=hostfs rootflags=/ ro init="$here/init.sh" patella_job="$job" \
  quiet loglevel=1 con=null con0=null,fd:1 ssl=null </dev/null 2>"$job/stderr" || status=$?
if [ ! -s "$job/status" ]; then
  cat "$job/stderr" >&2
  echo "run.sh: the guest ended without a status (kernel exit $status; 124 is the limit of $time_limit s)" >&2
  exit 99
fi
exit "$(cat "$job/status")"
