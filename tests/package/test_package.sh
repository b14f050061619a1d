#!/usr/bin/env bash
# Installs, runs, removes and purges the Debian package in a clean system made by debootstrap.
#
#   tests/package/test_package.sh PACKAGE.deb [CACHE-FOLDER]
#
# Needs root and debootstrap. Exit status 77 where that, or a system of the package's architecture, cannot be had.
set -euo pipefail
package=$(realpath "${1:?"usage: test_package.sh PACKAGE.deb [CACHE-FOLDER]"}")
cache=${2:-$(cd "$(dirname "$0")/../.." && pwd)/build/package}
mkdir -p "$cache"
cache=$(cd "$cache" && pwd)

unavailable() {
  echo "==================================================================" >&2
  echo "SKIPPED, the package was NOT tested: $*" >&2
  echo "==================================================================" >&2
  exit 77
}
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

[ "$(id -u)" -eq 0 ] || unavailable "needs root"
command -v debootstrap >/dev/null || unavailable "no debootstrap (package debootstrap)"
architecture=$(dpkg-deb -f "$package" Architecture)
[ "$architecture" = "$(dpkg --print-architecture)" ] || [ -e "/proc/sys/fs/binfmt_misc/qemu-aarch64" ] ||
  unavailable "$architecture programs need binfmt_misc with qemu-user-static, absent from this kernel"
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")

base=$cache/$suite-$architecture.tar
if [ ! -s "$base" ]; then
  rm -rf "$cache/base"
  debootstrap --arch="$architecture" --variant=minbase "$suite" "$cache/base" >"$cache/debootstrap.log" 2>&1 ||
    { tail -n 5 "$cache/debootstrap.log" >&2; unavailable "debootstrap failed, see $cache/debootstrap.log"; }
  tar -C "$cache/base" -cf "$base.new" .
  mv "$base.new" "$base"
  rm -rf "$cache/base"
fi

root=$(mktemp -d "$cache/root.XXXXXX")
clean() {
  umount "$root/proc" 2>/dev/null || true
  rm -rf --one-file-system "$root"
}
trap clean EXIT
tar -C "$root" -xf "$base"
mount -t proc proc "$root/proc" || unavailable "cannot mount /proc in the new system"
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
cp "$package" "$root/patella.deb"
find "$root" -xdev -not -path "$root/proc*" | sort >"$cache/before.txt"

echo "== install"
inside apt-get update -qq
inside apt-get install -y -qq --no-install-recommends /patella.deb >"$cache/install.log" 2>&1 ||
  { tail -n 20 "$cache/install.log" >&2; fail "the package does not install"; }
inside dpkg --audit
inside getent passwd patella >/dev/null || fail "no user patella after installation"
for file in /etc/patella/rig.toml /etc/patella/can/patella.dbc /lib/systemd/system/patella@.service \
    /lib/udev/rules.d/60-patella.rules /usr/share/man/man1/patella.1.gz; do
  # A minimal system may be told to leave manuals out.
  [ -e "$root$file" ] || grep -q 'path-exclude.*man' "$root"/etc/dpkg/dpkg.cfg.d/* 2>/dev/null || fail "no $file"
done

echo "== run"
inside patella --version
inside patella check --config /etc/patella/rig.toml >"$cache/check.txt" || fail "patella check: $(cat "$cache/check.txt")"
inside patella run --config /etc/patella/rig.toml --clock virtual --duration 3 --out /tmp/run >"$cache/run.txt" ||
  fail "patella run: $(cat "$cache/run.txt")"
grep -q 'final state active' "$cache/run.txt" || fail "patella run did not end active: $(cat "$cache/run.txt")"
inside patella-convert --decode /tmp/run/frames.log --dbc /etc/patella/can/patella.dbc --out /tmp/run/signals.csv
for program in patella patella-rig patella-convert patella-report; do
  inside "$program" --help >/dev/null || fail "$program --help"
done

echo "== remove"
echo "# edited by the administrator" >>"$root/etc/patella/rig.toml"
inside dpkg --remove patella >/dev/null
[ ! -e "$root/usr/bin/patella" ] || fail "removal left /usr/bin/patella"
grep -q edited "$root/etc/patella/rig.toml" || fail "removal lost an edited configuration"

echo "== purge"
inside dpkg --purge patella >/dev/null
[ ! -e "$root/etc/patella" ] || fail "purging left $(cd "$root" && find etc/patella | tr '\n' ' ')"
! inside getent passwd patella >/dev/null || fail "purging left the user patella"
find "$root" -xdev -not -path "$root/proc*" | sort | comm -13 "$cache/before.txt" - | grep -i patella | grep -v '^[^ ]*/tmp/' &&
  fail "purging left these files"
echo "installed, ran, was removed and purged: $(basename "$package")"
