#!/usr/bin/env bash
# Installs, runs, removes and purges the Debian package in a clean system made by debootstrap: beside this one where the
# package is for this machine, on the emulated board where it is for arm64 and this machine cannot run that.
#
#   tests/package/test_package.sh PACKAGE.deb [CACHE-FOLDER]
#
# Needs root and debootstrap. Exit status 77 where that, or a system of the package's architecture, cannot be had.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
package=$(realpath "${1:?"usage: test_package.sh PACKAGE.deb [CACHE-FOLDER]"}")
cache=${2:-$source_dir/build/package}
mkdir -p "$cache"
cache=$(cd "$cache" && pwd)

unavailable() {
  echo "==================================================================" >&2
  echo "SKIPPED, the package was NOT tested: $*" >&2
  echo "==================================================================" >&2
  exit 77
}

[ "$(id -u)" -eq 0 ] || unavailable "needs root"
command -v debootstrap >/dev/null || unavailable "no debootstrap (package debootstrap)"
architecture=$(dpkg-deb -f "$package" Architecture)
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")

root=
clean() {
  [ -z "$root" ] || {
    umount "$root/proc" 2>/dev/null || true
    rm -rf --one-file-system "$root"
  }
}
trap clean EXIT

# system NAME OPTION...: a fresh system of that name in $root.
system() {
  local base=$cache/$1.tar
  shift
  if [ ! -s "$base" ]; then
    rm -rf "$cache/base"
    debootstrap "$@" --arch="$architecture" --variant=minbase "$suite" "$cache/base" >"$cache/debootstrap.log" 2>&1 ||
      { tail -n 5 "$cache/debootstrap.log" >&2; unavailable "debootstrap failed, see $cache/debootstrap.log"; }
    tar -C "$cache/base" -cf "$base.new" .
    mv "$base.new" "$base"
    rm -rf "$cache/base"
  fi
  root=$(mktemp -d "$cache/root.XXXXXX")
  mkdir -p "$root$inside"
  tar -C "$root$inside" -xf "$base"
  cp "$package" "$root$inside/patella.deb"
  cp "$here/within.sh" "$root$inside/"
}

# The package of that name, or the first that provides it: debootstrap knows only packages.
provider() {
  [ -n "$(apt-cache show "$1" 2>/dev/null)" ] && echo "$1" ||
    apt-cache showpkg "$1" | awk '/^Reverse Provides/ { found = 1; next } found { sub(/:.*/, "", $1); print $1; exit }'
}

inside=
if [ "$architecture" = "$(dpkg --print-architecture)" ]; then
  system "$suite-$architecture"
  mount -t proc proc "$root/proc" || unavailable "cannot mount /proc in the new system"
  chroot "$root" /usr/bin/env -i bash /within.sh apt
elif [ "$architecture" = arm64 ]; then
  # Unpacked here, with what the package depends on, and configured on the board.
  inside=/debian
  needed=$(dpkg-deb -f "$package" Depends | sed 's/ *([^)]*)//g; s/, */ /g')
  needed=$(for name in $needed; do provider "$name"; done | paste -sd,)
  system "$suite-$architecture-foreign" --foreign --include="$needed"
  "$source_dir/tools/board/run.sh" package --add "$root" --artefacts "$cache/board"
else
  unavailable "no system of architecture $architecture"
fi
echo "installed, ran, was removed and purged: $(basename "$package")"
