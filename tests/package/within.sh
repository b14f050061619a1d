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
while read -r file; do
  # A minimal system may be told to leave manuals out.
  [ -e "$file" ] || grep -q 'path-exclude.*man' /etc/dpkg/dpkg.cfg.d/* 2>/dev/null || fail "no $file"
done < <(dpkg --listfiles patella)
# What the administrator may edit survives an upgrade and a removal.
dpkg-query --showformat '${Conffiles}\n' --show patella | awk 'NF { print $1 }' | sort >"$notes/conffiles"
dpkg --listfiles patella | while read -r file; do [[ $file != /etc/* ]] || [ -d "$file" ] || echo "$file"; done | sort |
  diff "$notes/conffiles" - || fail "these files below /etc are no configuration of the package, or the other way round"

echo "== run"
patella --version
grep -q '^duration_s = 0 ' /etc/patella/rig.toml || fail "a run of rig.toml ends by itself: $(grep duration_s /etc/patella/rig.toml)"
patella check --config /etc/patella/rig.toml >"$notes/check" || fail "patella check: $(cat "$notes/check")"
patella run --config /etc/patella/rig.toml --clock virtual --duration 3 --out /tmp/run >"$notes/run" ||
  fail "patella run: $(cat "$notes/run")"
grep -q 'final state active' "$notes/run" || fail "patella run did not end active: $(cat "$notes/run")"
grep -q 'the network leaves' "$notes/run" || fail "patella run ran no network: $(cat "$notes/run")"
cat "$notes/run"
patella-convert --decode /tmp/run/frames.log --dbc /etc/patella/can/patella.dbc --out /tmp/run/signals.csv
for program in $(dpkg --listfiles patella | grep '^/usr/bin/'); do
  "$program" --help >/dev/null || fail "$program --help"
done

echo "== run with drives of others"
# with_drives NAME KIND [KEYS]: the configuration with that map and two simulated drives of that kind.
with_drives() {
  local joint
  sed "s|^map = .*|map = \"can/$1.toml\"|" /etc/patella/rig.toml
  for joint in 1 2; do
    printf '[[rig.drive_model]]\nkind = "%s"\nid = %d\ntorque_limit_Nm = 144\n%s\n' "$2" "$joint" "${3:-}"
  done
}
with_drives odrive_cansimple odrive >/etc/patella/with_drives.toml
patella run --config /etc/patella/with_drives.toml --clock virtual --duration 3 --out /tmp/drives >"$notes/run" ||
  fail "patella run with odrive_cansimple.toml: $(cat "$notes/run")"
grep -q 'final state active' "$notes/run" || fail "with odrive_cansimple.toml it did not end active: $(cat "$notes/run")"
# The other map is a template: the ranges of the motors are the administrator's to state.
with_drives mit_mode mit >/etc/patella/with_drives.toml
! patella check --config /etc/patella/with_drives.toml >"$notes/check" 2>&1 || fail "mit_mode.toml is taken without ranges"
grep -q 'Motor1Command.*a range in the bus map' "$notes/check" || fail "nobody is told that mit_mode.toml lacks ranges: $(cat "$notes/check")"
rm /etc/patella/with_drives.toml

echo "== watch a live run"
patella run --config /etc/patella/rig.toml --duration 0 --out /tmp/live >"$notes/live" 2>&1 &
loop=$!
for _ in $(seq 600); do [ ! -s /tmp/live/ticks.csv ] || break; sleep 0.1; done
patella view /tmp/live --listen 127.0.0.1:8765 >"$notes/view" 2>&1 &
view=$!
for _ in $(seq 600); do ! grep -q '^serving' "$notes/view" || break; sleep 0.1; done
grep -q '^serving .*, live at http://127.0.0.1:8765' "$notes/view" || fail "patella view: $(cat "$notes/view" "$notes/live")"
exec 3<>/dev/tcp/127.0.0.1/8765
printf '%s\r\n' 'GET / HTTP/1.1' 'Host: 127.0.0.1:8765' 'Connection: Upgrade' 'Upgrade: websocket' 'Sec-WebSocket-Version: 13' \
  'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==' 'Sec-WebSocket-Protocol: foxglove.websocket.v1' '' >&3
read -r -t 60 answer <&3 || fail "patella view does not answer"
[[ $answer == *' 101 '* ]] || fail "patella view answers '$answer', expected 101"
exec 3>&-
kill -INT "$loop"
wait "$loop" || [ $? -eq 3 ] || fail "the watched run: $(cat "$notes/live")"  # 3: this machine stood still
wait "$view" || fail "patella view ended with $?: $(cat "$notes/view")"

echo "== install once more, and remove"
echo "# edited by the administrator" >>/etc/patella/rig.toml
dpkg --install /patella.deb >"$notes/again" 2>&1 || fail "the package does not install over itself: $(tail -n 5 "$notes/again")"
grep -q edited /etc/patella/rig.toml || fail "installing once more lost an edited configuration"
dpkg --remove patella >/dev/null
[ ! -e /usr/bin/patella ] || fail "removal left /usr/bin/patella"
grep -q edited /etc/patella/rig.toml || fail "removal lost an edited configuration"

echo "== purge"
dpkg --purge patella >/dev/null
[ ! -e /etc/patella ] || fail "purging left $(find /etc/patella | tr '\n' ' ')"
! getent passwd patella >/dev/null || fail "purging left the user patella"
files | comm -13 "$notes/before" - | grep -i patella && fail "purging left these files"
echo "installed, ran, was removed and purged on $(dpkg --print-architecture)"
