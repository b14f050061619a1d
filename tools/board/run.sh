#!/usr/bin/env bash
# Boots the emulated board with this project's programs, runs a scenario on it and shows its console meanwhile.
#
#   tools/board/run.sh SCENARIO [--artefacts DIR] [--kernel rt|plain] [--limit SECONDS] [--add DIR] [-- ARGUMENT...]
#
# SCENARIO is a shell script, or the name of one in tests/board/qemu/scenarios. Lines in it that begin with "# board:"
# say what it needs: kernel=rt|plain, time=counted|wall, can=CONTROLLERS, isolated=yes (a second processor, kept for
# the loop as docs/rig.md has it), memory=MB, limit=SECONDS, program=PATH in the build tree. --add puts the files below
# DIR into the board's root.
# Counted time (the default) passes with the instructions executed, whatever else the host does: a run repeats exactly.
# Wall time is the host's.
#
# Exits with the scenario's status; 77 where the board cannot be had here; 99 when it ended without a status. DIR
# (build/board/runs/NAME) then holds serial.log, kernel.log and whatever the scenario left in $PATELLA_ARTEFACTS.
#
# Environment: PATELLA_BIN_DIR      arm64 build tree; without it, build/arm64 is brought up to date first
#              PATELLA_LIBRARIES    folders of the arm64 libraries that it was linked to (those of the host)
#              PATELLA_BOARD_CACHE  where packages and images are kept (~/.cache/patella/board)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
. "$here/cache.sh"
. "$here/libraries.sh"

usage() { sed -n '2,20s/^# \{0,1\}//p' "$0" >&2; exit 2; }
unavailable() {
  echo "==================================================================" >&2
  echo "SKIPPED, NOT tested on the emulated board: $*" >&2
  echo "==================================================================" >&2
  exit 77
}

[ $# -ge 1 ] || usage
case $1 in -h | --help) usage ;; esac
scenario=$1; shift
[ -f "$scenario" ] || scenario=$source_dir/tests/board/qemu/scenarios/$scenario.sh
[ -f "$scenario" ] || { echo "run.sh: no scenario $scenario" >&2; exit 2; }
name=$(basename "$scenario" .sh)

# Needs of the scenario, then the command line.
kernel=rt time=counted can=0 isolated=no memory=512 limit=150 programs=() artefacts= add=
for need in $(sed -n 's/^# board://p' "$scenario"); do
  case $need in
    kernel=* | time=* | can=* | isolated=* | memory=* | limit=*) declare "$need" ;;
    program=*) programs+=("${need#program=}") ;;
    *) echo "run.sh: $scenario: unknown need '$need'" >&2; exit 2 ;;
  esac
done
while [ $# -gt 0 ]; do
  case $1 in
    --artefacts | --kernel | --limit | --add) [ $# -ge 2 ] || usage; declare "${1#--}=$2"; shift 2 ;;
    --) shift; break ;;
    *) usage ;;
  esac
done
[[ $kernel =~ ^(rt|plain)$ ]] || { echo "run.sh: kernel '$kernel', expected rt or plain" >&2; exit 2; }
[ -z "$add" ] || [ -d "$add" ] || { echo "run.sh: --add: no folder $add" >&2; exit 2; }
[[ $time =~ ^(counted|wall)$ ]] || { echo "run.sh: time '$time', expected counted or wall" >&2; exit 2; }

for tool in qemu-system-aarch64 python3 cpio; do
  command -v "$tool" >/dev/null || unavailable "no $tool (tools/setup.sh --cross)"
done
status=0
image=$("$here/image.sh" "$kernel") || status=$?
[ "$status" -ne 77 ] || unavailable "its packages cannot be had"
[ "$status" -eq 0 ] || exit "$status"

if [ -z "${PATELLA_BIN_DIR:-}" ]; then
  PATELLA_BIN_DIR=$source_dir/build/arm64
  (cd "$source_dir" && { [ -f build/arm64/build.ninja ] || cmake --preset arm64 >&2; } &&
    cmake --build --preset arm64 --target patella patella-rig patella_board_{host_call,never_idle} "${programs[@]##*/}" >&2)
fi

# Additions of this run to the image.
mkdir -p "$source_dir/build/board"
work=$(mktemp -d "$source_dir/build/board/run.XXXXXX")
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir -p "$root/job" "$root/usr/local/bin" "$root/opt/patella" "$work/console"
for program in firmware_app/patella{,-rig} tools/board/{host_call,never_idle} "${programs[@]}"; do
  aarch64-linux-gnu-strip -o "$root/usr/local/bin/${program##*/}" "$PATELLA_BIN_DIR/$program"
done
read -ra libraries <<<"${PATELLA_LIBRARIES:-/usr/lib/aarch64-linux-gnu /usr/aarch64-linux-gnu/lib}"
copy_libraries "$root" "${libraries[@]}"
(cd "$source_dir" && cp -r --parents firmware_app/config drivers/can/*.dbc tests/board/qemu tools/bench/faults/rigs "$root/opt/patella/")
cp "$scenario" "$root/job/scenario"
{
  echo "export PATELLA_SOURCE=/opt/patella"
  # With two processors the other one waits for this one's instructions.
  [ "$time$isolated" != countedno ] || echo "never_idle &"
  printf 'set --'
  [ $# -eq 0 ] || printf " '%s'" "${@//\'/\'\\\'\'}"
  echo
} >"$root/job/settings"
make_cpio "$root" "$work/job.cpio"
cat "$image/base.cpio" "$work/job.cpio" >"$work/initramfs"
if [ -n "$add" ]; then
  cp -a "$add" "$work/add"
  make_cpio "$work/add" "$work/add.cpio"
  cat "$work/add.cpio" >>"$work/initramfs"
  rm -rf "$work/add" "$work/add.cpio"
fi

append="console=ttyAMA0 nokaslr norandmaps quiet panic=-1 rdinit=/init"
processors=1
if [ "$isolated" = yes ]; then
  processors=2
  append+=" isolcpus=managed_irq,domain,1 nohz_full=1 rcu_nocbs=1 irqaffinity=0"
fi
qemu=(qemu-system-aarch64 -M virt,dtb-randomness=off -cpu cortex-a72 -smp "$processors" -m "$memory" -nodefaults -display none -no-reboot
  -kernel "$image/vmlinuz" -initrd "$work/initramfs"
  -append "$append"
  -chardev stdio,id=console,signal=off -serial chardev:console
  -semihosting-config enable=on,userspace=on)
if [ "$time" = counted ]; then
  qemu+=(-icount shift=0,sleep=off -rtc base=2020-01-01,clock=vm)
fi
if [ "$can" -gt 0 ]; then
  qemu+=(-object can-bus,id=bus)
  for ((i = 0; i < can; ++i)); do qemu+=(-device kvaser_pci,canbus=bus); done
fi

started=$(date +%s)
ended=0
python3 "$here/console.py" --limit "$limit" --folder "$work/console" -- "${qemu[@]}" || ended=$?
artefacts=${artefacts:-$source_dir/build/board/runs/$name}
rm -rf "$artefacts"
mkdir -p "$artefacts"
cp "$work/console/serial.log" "$artefacts/"
if [ -s "$work/console/artefacts.tar" ]; then
  tar -x -C "$artefacts" -f "$work/console/artefacts.tar"
fi
status=99
if [ "$ended" = 0 ] && [ -s "$work/console/status" ]; then
  status=$(cat "$work/console/status")
fi
echo "board: $name, kernel $(cat "$image/release"), $time time: status $status after $(($(date +%s) - started)) s"
if [ "$status" != 0 ]; then
  [ "$status" != 99 ] || echo "run.sh: the board ended without a status" >&2
  echo "run.sh: serial log and artefacts in $artefacts" >&2
fi
exit "$status"
