#!/usr/bin/env bash
# A release's parts: bill of materials, checksums and signature of a package of this build; and what tools/release.sh refuses.
#
#   release.sh BUILD_DIR VERSION SCRATCH
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../../.." && pwd)
build=$(realpath "${1:?"usage: release.sh BUILD_DIR VERSION SCRATCH"}")
version=$2
scratch=$3
rm -rf "$scratch"
mkdir -p "$scratch/files"
scratch=$(cd "$scratch" && pwd)

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
# refuses WORDS COMMAND...: the command fails, and says that.
refuses() {
  local words=$1 said
  shift
  ! said=$("$@" 2>&1) || fail "passed: $*"
  grep -qF -- "$words" <<<"$said" || fail "$*: said '$said', expected '$words'"
}
# flip FILE: one bit of one byte in its middle.
flip() {
  python3 -c 'import sys
with open(sys.argv[1], "r+b") as file:
    data = bytearray(file.read())
    data[len(data) // 2] ^= 1
    file.seek(0)
    file.write(data)' "$1"
}

echo "== package and bill of materials"
export SOURCE_DATE_EPOCH=1700000000
(cd "$build" && cpack -G DEB -B "$scratch/cpack" >"$scratch/cpack.log" 2>&1) || { cat "$scratch/cpack.log"; fail "no package"; }
deb=$(echo "$scratch"/cpack/patella_*.deb)
[ "$(dpkg-deb --field "$deb" Version)" = "$version" ] || fail "$deb is not version $version"
cp "$deb" "$scratch/files/"
bom=$scratch/files/$(basename "$deb" .deb).spdx.json
sbom() { "$source_dir/tools/release/sbom.py" --build "$build" --package "$deb" --epoch "$SOURCE_DATE_EPOCH" --out "$1"; }
sbom "$bom"
python3 "$here/check_sbom.py" "$bom" "$deb" || fail "the bill of materials does not hold"
sbom "$scratch/again.json" >/dev/null
cmp "$bom" "$scratch/again.json" || fail "the bill of materials differs from one time to the next"

# That check can fail: a library too few, one too many, one byte of one, headers too few.
spoil() {
  python3 - "$bom" "$scratch/spoilt.json" "$1" <<'PY'
import copy, json, sys
document = json.load(open(sys.argv[1]))
packages = document["packages"]
library = next(entry for entry in packages if entry["name"].startswith("libgpiod.so."))
def drop(entry):
    packages.remove(entry)
    document["relationships"] = [r for r in document["relationships"] if entry["SPDXID"] not in r.values()]
if sys.argv[3] == "lacks":
    drop(library)
elif sys.argv[3] == "which ldd does not show":
    other = copy.deepcopy(library)
    other.update(name="libceres.so.3", SPDXID="SPDXRef-Library-libceres")
    packages.append(other)
    relation = next(r for r in document["relationships"] if r["relatedSpdxElement"] == library["SPDXID"])
    document["relationships"].append({**relation, "relatedSpdxElement": other["SPDXID"]})
elif sys.argv[3] == "has another SHA-256":
    library["checksums"][0]["checksumValue"] = "0" * 64
elif sys.argv[3] == "headers of libcli11-dev":
    drop(next(entry for entry in packages if entry["name"] == "libcli11-dev"))
json.dump(document, open(sys.argv[2], "w"))
PY
  refuses "$1" python3 "$here/check_sbom.py" "$scratch/spoilt.json" "$deb"
}
for spoilt in lacks "which ldd does not show" "has another SHA-256" "headers of libcli11-dev"; do
  spoil "$spoilt"
done

echo "== SOUP and requirements in docs/iec62304.md"
tables() { "$source_dir/tools/release/iec62304.py" --sbom "$bom" --check "$@"; }
tables || fail "the tables of docs/iec62304.md are old"
for spoilt in '/^| tomlplusplus /d' 's/^\(| eigen3 | .*\) MPL-2.0 /\1 MIT /' '0,/^| H2\.1 /{/^| H2\.1 /d}'; do
  sed "$spoilt" "$source_dir/docs/iec62304.md" >"$scratch/spoilt.md"
  ! cmp -s "$scratch/spoilt.md" "$source_dir/docs/iec62304.md" || fail "nothing is spoilt by $spoilt"
  refuses "make them agree" tables --document "$scratch/spoilt.md"
done
sed 's/2\.36-9[^ |]*/2.41-1/' "$source_dir/docs/iec62304.md" >"$scratch/newer.md"
tables --document "$scratch/newer.md" || fail "another version of a part is no reason to refuse"

echo "== checksums and signature, with a key made for this test"
for name in own other; do
  minisign -G -W -p "$scratch/$name.pub" -s "$scratch/$name.key" >/dev/null
done
seal() { "$source_dir/tools/release/seal.sh" "$scratch/files" "patella $version" "$@"; }
verify() { (cd "$scratch/files" && minisign -V -q -m SHA256SUMS -p "$scratch/${1:-own}.pub" && sha256sum --check --strict SHA256SUMS); }
grep -q "not signed" <<<"$(seal)" || fail "nobody is told that nothing is signed"
[ ! -e "$scratch/files/SHA256SUMS.minisig" ] || fail "a signature without a key"
refuses "cannot be read" seal "$scratch/no.key"
seal "$scratch/own.key" >/dev/null
cp "$scratch/files/SHA256SUMS.minisig" "$scratch/first.minisig"
seal "$scratch/own.key" >/dev/null
cmp "$scratch/first.minisig" "$scratch/files/SHA256SUMS.minisig" || fail "the signature differs from one time to the next"
verify >/dev/null || fail "what was sealed does not verify"
[ "$(wc -l <"$scratch/files/SHA256SUMS")" -eq 2 ] || fail "not every file is in SHA256SUMS"
refuses "" verify other
for file in "$(basename "$deb")" "$(basename "$bom")" SHA256SUMS; do
  cp "$scratch/files/$file" "$scratch/kept"
  flip "$scratch/files/$file"
  refuses "" verify
  cp "$scratch/kept" "$scratch/files/$file"
  verify >/dev/null || fail "$file, put back, does not verify"
done

echo "== what tools/release.sh refuses"
clone=$scratch/clone
if ! git clone -q "$source_dir" "$clone" 2>"$scratch/clone.log"; then
  echo "SKIPPED: what tools/release.sh refuses needs the repository: $(cat "$scratch/clone.log")" >&2
  exit 77
fi
cp "$source_dir/tools/release.sh" "$clone/tools/release.sh"
git -C "$clone" -c user.name=test -c user.email=test@localhost commit -qam "what is being tested" >/dev/null || true
release() { "$clone/tools/release.sh" --out "$scratch/out" --architecture "$(dpkg --print-architecture)" "$@"; }
refuses "unknown argument '--fast'" release --fast x
refuses "architecture 'riscv64', expected amd64 or arm64" release --architecture riscv64
refuses "cannot be read" release --key "$scratch/no.key"
mkdir "$scratch/bin"
for tool in bash dirname git env; do
  ln -s "$(command -v "$tool")" "$scratch/bin/"
done
refuses "no cmake, which tools/setup.sh brings" env PATH="$scratch/bin" "$clone/tools/release.sh"
echo "not committed" >"$clone/note.txt"
refuses "note.txt" release
[ ! -e "$scratch/out" ] || fail "a release that was refused left $scratch/out"
echo "the parts of a release hold, and fail where they must"
