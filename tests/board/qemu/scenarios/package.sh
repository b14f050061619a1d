# The Debian package in a clean system of this architecture, which tests/package/test_package.sh has put into /debian:
# unpacked, to be configured here.
# board: kernel=plain time=wall memory=2048 limit=3000
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
[ -x /debian/debootstrap/debootstrap ] || { fail "no Debian in /debian, see tests/package/test_package.sh"; finish; }
status=0
chroot /debian /debootstrap/debootstrap --second-stage || status=$?
expect "exit status of debootstrap" "$status" -eq 0
cp /debian/debootstrap/debootstrap.log "$PATELLA_ARTEFACTS/" 2>/dev/null
mount -t proc proc /debian/proc
ip link set lo up
chroot /debian bash /within.sh dpkg || status=$?
expect "exit status of the package's test" "$status" -eq 0
finish
