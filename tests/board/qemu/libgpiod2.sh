#!/usr/bin/env bash
# The loop with libgpiod 2 on the board's lines: cross-built in a Debian 13, whose library that is, and run in the
# scenario of the emergency stop.
#
#   tests/board/qemu/libgpiod2.sh [--artefacts DIR] [SCENARIO]
#
# Needs root and mmdebstrap; the Debian 13 is kept with the board's packages (tools/board/cache.sh). Exit status: the
# scenario's; 77 where a Debian 13 or the board cannot be had.
set -euo pipefail
# Mounts in a namespace of their own go when this ends, however it ends.
if [ -z "${PATELLA_OWN_MOUNTS:-}" ] && unshare --mount true 2>/dev/null; then
  PATELLA_OWN_MOUNTS=yes exec unshare --mount "$0" "$@"
fi
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
. "$source_dir/tools/packages.sh"
. "$source_dir/tools/board/cache.sh"
root=$board_cache/trixie
built=$source_dir/build/arm64-libgpiod2
artefacts=$source_dir/build/board/runs/libgpiod2
if [ "${1:-}" = --artefacts ]; then
  artefacts=${2:?"--artefacts DIR"}
  shift 2
fi
scenario=${1:-emergency_stop}

unavailable() {
  echo "==================================================================" >&2
  echo "SKIPPED, libgpiod 2 was NOT tested: $*" >&2
  echo "==================================================================" >&2
  exit 77
}
[ "$(id -u)" -eq 0 ] || unavailable "needs root"
[ -n "${PATELLA_OWN_MOUNTS:-}" ] || unavailable "mounts of its own are not allowed here (unshare --mount)"
for tool in mmdebstrap qemu-aarch64-static; do
  command -v "$tool" >/dev/null || unavailable "no $tool (tools/setup.sh --cross)"
done

exec 8>"$board_cache/trixie.lock"
flock 8
wanted=("${portable_packages[@]}" "$cross_compiler" "${cross_libraries[@]}")
if [ "$(cat "$root.complete" 2>/dev/null)" != "${wanted[*]}" ]; then
  echo "== Debian 13: packages"
  rm -rf --one-file-system "$root" "$root.complete"
  mmdebstrap --mode=root --variant=apt --architectures="$(dpkg --print-architecture),arm64" \
    --aptopt='APT::Install-Recommends "false"' --dpkgopt=force-unsafe-io --dpkgopt='path-exclude=/usr/share/doc/*' \
    --include="$(IFS=,; echo "${wanted[*]}")" trixie "$root" >"$root.log" 2>&1 || unavailable "mmdebstrap failed, see $root.log"
  echo "${wanted[*]}" >"$root.complete"
fi
ccache_dir=$(ccache -k cache_dir)
mkdir -p "$root"/{source,ccache,build} "$ccache_dir" "$built"
mount -t proc proc "$root/proc" || unavailable "cannot mount /proc in the new system"
mount --bind "$ccache_dir" "$root/ccache"
mount --bind "$source_dir" "$root/source"
mount --bind "$built" "$root/build"
mount -o remount,bind,ro "$root/source"
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 CCACHE_DIR=/ccache "$@"; }

# Lightly optimised and without symbols, which takes two thirds of the time: it is the lines that are tested here.
echo "== Debian 13: cross build"
inside cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" \
  -DPATELLA_TOOLS=OFF -DCMAKE_TOOLCHAIN_FILE=/source/tools/cmake/aarch64-linux-gnu.cmake >"$root.configure.log" 2>&1 ||
  { cat "$root.configure.log"; exit 1; }
inside cmake --build /build \
  --target patella patella-rig gpiod_pins_test patella_board_host_call patella_board_never_idle
readelf -d "$built/firmware_app/patella" | grep -q 'NEEDED.*libgpiod\.so\.3' ||
  { echo "FAILED: patella is not linked to libgpiod.so.3, expected libgpiod 2"; exit 1; }
echo "== Debian 13: cases of gpiod_pins_test under user emulation"
qemu-aarch64-static -L "$root" "$built/tests/unit/gpio/gpiod_pins_test"

echo "== the board, with libgpiod $(inside dpkg-query -W -f '${Version}' libgpiod3:arm64)"
PATELLA_BIN_DIR=$built PATELLA_LIBRARIES="$root/usr/lib/aarch64-linux-gnu $root/usr/aarch64-linux-gnu/lib" \
  "$source_dir/tools/board/run.sh" "$scenario" --artefacts "$artefacts"
