#!/usr/bin/env bash
# Makes what the emulated board boots from the distribution's packages, unpacked and never installed: an arm64 kernel
# and an initramfs with busybox, ip, can-utils, chrt, cyclictest and the kernel modules of CAN. Downloads and results are kept.
#
#   tools/board/image.sh rt|plain [--refresh]
#
# rt is the newest PREEMPT_RT kernel of the distribution, plain the one without; --refresh looks for newer packages.
# Prints the folder of the result, which holds vmlinuz and base.cpio. PATELLA_BOARD_CACHE: where to keep things
# (~/.cache/patella/board). Exit status 77 where the packages cannot be had.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/cache.sh"
. "$here/libraries.sh"

kernel=${1:-}
case $kernel in
  rt) metapackage=linux-image-rt-arm64 ;;
  plain) metapackage=linux-image-arm64 ;;
  *) sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
cache=$board_cache
mkdir -p "$cache/packages"
result=$cache/$kernel
programs=(busybox-static can-utils iproute2 rt-tests util-linux)
modules=(can-raw vcan kvaser_pci)

unavailable() {
  echo "tools/board/image.sh: $*" >&2
  exit 77
}

exec 9>"$cache/lock"
flock 9
stamp=$(cat "$here/image.sh" "$here/libraries.sh" "$here"/guest/init | sha256sum)
if [ "${2:-}" != --refresh ] && [ "$(cat "$result/stamp" 2>/dev/null)" = "$stamp" ]; then
  echo "$result"
  exit 0
fi

for tool in apt-get cpio depmod modprobe readelf; do
  PATH=$PATH:/usr/sbin:/sbin command -v "$tool" >/dev/null || unavailable "no $tool (tools/setup.sh --cross)"
done
dpkg --print-foreign-architectures | grep -qx arm64 || [ "$(dpkg --print-architecture)" = arm64 ] ||
  unavailable "packages for arm64 are unknown here (tools/setup.sh --cross)"

work=$(mktemp -d "$cache/work.XXXXXX")
trap 'rm -rf "$work"' EXIT

# download PACKAGE...: the arm64 packages of these names into the cache, which keeps one version of each; prints the files.
download() {
  local file files missing=()
  # In a folder of its own: apt-get says nothing of files that are there already.
  files=$(cd "$work" && apt-get -q download --print-uris "${@/%/:arm64}" | awk '/^.http/ { print $2 }') ||
    unavailable "the distribution lacks one of these packages for arm64: $*"
  for file in $files; do
    if [ ! -s "$cache/packages/$file" ]; then
      rm -f "$cache/packages/${file%%_*}_"*.deb
      missing+=("${file%%_*}:arm64")
    fi
  done
  if [ ${#missing[@]} -gt 0 ]; then
    echo "board image: downloading ${missing[*]}" >&2
    (cd "$cache/packages" && apt-get -qq -o APT::Sandbox::User=root download "${missing[@]}" >&2) ||
      unavailable "cannot download ${missing[*]}"
  fi
  printf '%s\n' $files | sed "s|^|$cache/packages/|"
}

# The libraries among the packages that an empty arm64 machine would install with $programs.
library_packages() {
  : >"$cache/nothing-installed"
  apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::status="$cache/nothing-installed" \
    --no-install-recommends --print-uris install "$@" 2>/dev/null | awk '/^.http/ { print $2 }' |
    sed -n 's/^\(z\{0,1\}lib[^_]*\)_.*_arm64\.deb$/\1/p' | grep -v python
}

release=$(apt-cache depends "$metapackage:arm64" 2>/dev/null |
  sed -n 's/^ *Depends: linux-image-\([^:]*\).*/\1/p' | head -n 1)
[ -n "$release" ] || unavailable "the distribution has no $metapackage for arm64 (apt-get update?)"
echo "board image: kernel $release" >&2
kernel_file=$(download "linux-image-$release") || exit
mapfile -t library_names < <(library_packages "${programs[@]}")
program_files=$(download "${programs[@]}") || exit
library_files=$(download "${library_names[@]}") || exit

mkdir "$work/packages" "$work/kernel"
for file in $program_files $library_files; do
  dpkg -x "$file" "$work/packages"
done
dpkg-deb --fsys-tarfile "$kernel_file" |
  tar -x -C "$work/kernel" --wildcards ./boot './lib/modules/*/modules.*' './lib/modules/*/kernel/net/can*' \
    './lib/modules/*/kernel/drivers/net/can*'

root=$work/root
mkdir -p "$root"/{bin,dev,etc,lib,proc,run,sbin,sys,tmp,usr/bin,usr/sbin}
install -m 755 "$here/guest/init" "$root/init"
cp "$work"/packages/bin/busybox "$root/bin/"
cp "$work"/packages/bin/ip "$root/usr/sbin/ip"
for program in candump cangen canplayer cansend chrt cyclictest log2asc; do
  cp "$work/packages/usr/bin/$program" "$root/usr/bin/"
done
PATH=$PATH:/usr/sbin:/sbin
depmod -b "$work/kernel" "$release"
for module in "${modules[@]}"; do
  modprobe -d "$work/kernel" -S "$release" --show-depends "$module" | awk '/^insmod/ { print $2 }'
done | sort -u | while read -r file; do
  install -D -m 644 "$file" "$root/${file#"$work/kernel"}"
done
cp "$work/kernel/lib/modules/$release"/modules.{builtin,builtin.modinfo,order} "$root/lib/modules/$release/"
depmod -b "$root" "$release"
copy_libraries "$root" /usr/lib/aarch64-linux-gnu "$work"/packages/{lib,usr/lib}/aarch64-linux-gnu

rm -rf "$result"
mkdir "$result"
make_cpio "$root" "$result/base.cpio"
mv "$work/kernel/boot/vmlinuz-$release" "$result/vmlinuz"
echo "$release" >"$result/release"
echo "$stamp" >"$result/stamp"
echo "$result"
