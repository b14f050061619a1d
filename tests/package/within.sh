#!/usr/bin/env bash
# Installs, runs, removes and purges /patella.deb in the system it is run in, as root. test_package.sh makes that system.
#
#   within.sh apt|dpkg      apt fetches what the package depends on; for dpkg it is there already
set -euo pipefail
export PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
by=${1:?"usage: within.sh apt|dpkg"}
notes=$(mktemp -d)

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
files() {
  find / -xdev -not -path '/proc*' -not -path '/tmp/*' -not -path '/sys*' -not -path '/dev*' | sort
}

files >"$notes/before"
echo "== install"
if [ "$by" = apt ]; then
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends /patella.deb >"$notes/install" 2>&1 ||
    { tail -n 20 "$notes/install" >&2; fail "the package does not install"; }
else
  dpkg --install /patella.deb >"$notes/install" 2>&1 ||
    { tail -n 20 "$notes/install" >&2; fail "the package does not install"; }
fi
dpkg --audit
getent passwd patella >/dev/null || fail "no user patella after installation"
for file in /etc/patella/rig.toml /etc/patella/can/patella.dbc /etc/patella/weights/demonstration.safetensors /lib/systemd/system/patella@.service \
    /lib/udev/rules.d/60-patella.rules /usr/share/man/man1/patella.1.gz; do
  # A minimal system may be told to leave manuals out.
  [ -e "$file" ] || grep -q 'path-exclude.*man' /etc/dpkg/dpkg.cfg.d/* 2>/dev/null || fail "no $file"
done

echo "== run"
patella --version
patella check --config /etc/patella/rig.toml >"$notes/check" || fail "patella check: $(cat "$notes/check")"
patella run --config /etc/patella/rig.toml --clock virtual --duration 3 --out /tmp/run >"$notes/run" ||
  fail "patella run: $(cat "$notes/run")"
grep -q 'final state active' "$notes/run" || fail "patella run did not end active: $(cat "$notes/run")"
grep -q 'the network leaves' "$notes/run" || fail "patella run ran no network: $(cat "$notes/run")"
cat "$notes/run"
patella-convert --decode /tmp/run/frames.log --dbc /etc/patella/can/patella.dbc --out /tmp/run/signals.csv
for program in patella patella-rig patella-convert patella-report; do
  "$program" --help >/dev/null || fail "$program --help"
done

echo "== remove"
echo "# edited by the administrator" >>/etc/patella/rig.toml
dpkg --remove patella >/dev/null
[ ! -e /usr/bin/patella ] || fail "removal left /usr/bin/patella"
grep -q edited /etc/patella/rig.toml || fail "removal lost an edited configuration"

echo "== purge"
dpkg --purge patella >/dev/null
[ ! -e /etc/patella ] || fail "purging left $(find /etc/patella | tr '\n' ' ')"
! getent passwd patella >/dev/null || fail "purging left the user patella"
files | comm -13 "$notes/before" - | grep -i patella && fail "purging left these files"
echo "installed, ran, was removed and purged on $(dpkg --print-architecture)"
