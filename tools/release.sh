#!/usr/bin/env bash
# Makes a release of what is committed: source archive, Debian packages, a bill of materials of each (SPDX), checksums and,
# with a key, their signature. The same commit, on the same system, gives the same bytes wherever it stands.
#
#   tools/release.sh [--out FOLDER] [--architecture ARCHITECTURE]... [--key FILE]
#
#   --out FOLDER          default build/release-VERSION; what it holds of a release before is replaced
#   --architecture NAME   amd64 or arm64, once for each; default: this machine's, and arm64
#   --key FILE            secret key of minisign; default: the environment's PATELLA_RELEASE_KEY; without one nothing is signed
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD

fail() {
  echo "tools/release.sh: $*" >&2
  exit 1
}
started=$SECONDS
progress() { printf '[%3d s] %s\n' "$((SECONDS - started))" "$*"; }

out=
key=${PATELLA_RELEASE_KEY:-}
architectures=()
while [ $# -gt 0 ]; do
  case "$1" in
    --out | --architecture | --key) [ $# -ge 2 ] || { echo "tools/release.sh: $1 needs a value" >&2; exit 2; } ;;&
    --out) out=$2 ;;
    --key) key=$2 ;;
    --architecture)
      [[ $2 =~ ^(amd64|arm64)$ ]] || { echo "tools/release.sh: architecture '$2', expected amd64 or arm64" >&2; exit 2; }
      architectures+=("$2")
      ;;
    *)
      echo "tools/release.sh: unknown argument '$1', expected --out, --architecture or --key" >&2
      exit 2
      ;;
  esac
  shift 2
done

need() { command -v "$1" >/dev/null || fail "no $1, which $2 brings"; }
for tool in git cmake ninja dpkg-deb dpkg-shlibdeps gzip python3 readelf sha256sum strip; do
  need "$tool" "tools/setup.sh"
done
host=$(dpkg --print-architecture)
[ ${#architectures[@]} -gt 0 ] || mapfile -t architectures < <(printf '%s\n' "$host" arm64 | sort -u)
for architecture in "${architectures[@]}"; do
  if [ "$architecture" != "$host" ]; then
    [ "$architecture" = arm64 ] || fail "a package for $architecture can be built on $architecture only, not on $host"
    need aarch64-linux-gnu-g++ "tools/setup.sh --cross"
  fi
done
if [ -n "$key" ]; then
  [ -r "$key" ] || fail "key '$key' cannot be read, expected a secret key of minisign"
  need minisign "package minisign"
fi

changed=$(git status --porcelain)
[ -z "$changed" ] || fail "a release is made of what is committed, and these files differ:
$changed"
version=$(sed -nE 's/^project\(patella VERSION ([0-9]+\.[0-9]+\.[0-9]+) .*/\1/p' CMakeLists.txt)
[ -n "$version" ] || fail "CMakeLists.txt states no version, expected 'project(patella VERSION X.Y.Z'"
# Every stamp in every file is that of the commit.
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH LC_ALL=C TZ=UTC
umask 022
out=${out:-build/release-$version}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/files"

name=patella-$version
progress "source archive of $(git rev-parse --short HEAD)"
git -c tar.umask=0022 archive --format=tar --prefix="$name/" HEAD | gzip -9 -n >"$work/files/$name.tar.gz"

# package ARCHITECTURE: built from the source archive alone, as whoever downloads it would.
package() {
  local architecture=$1 preset=release build
  [ "$architecture" = "$host" ] || preset=arm64
  mkdir "$work/$architecture"
  tar -C "$work/$architecture" -xzf "$work/files/$name.tar.gz"
  build=$work/$architecture/$name/build/$preset
  progress "$architecture: configure"
  (
    cd "$work/$architecture/$name"
    # Where it was built must not show in what was built.
    cmake --preset "$preset" -DPATELLA_TOOLS=OFF -DBUILD_TESTING=OFF \
      -DCMAKE_CXX_FLAGS="-ffile-prefix-map=$PWD=/usr/src/$name" >"$work/$architecture.log" 2>&1 ||
      { cat "$work/$architecture.log" >&2; fail "$architecture cannot be configured"; }
    progress "$architecture: build"
    cmake --build --preset "$preset" --target patella_package >"$work/$architecture.log" 2>&1 ||
      { tail -n 40 "$work/$architecture.log" >&2; fail "$architecture cannot be built"; }
  )
  progress "$architecture: Debian package"
  (cd "$build" && cpack -G DEB >"$work/$architecture.log" 2>&1) ||
    { cat "$work/$architecture.log" >&2; fail "no package for $architecture"; }
  cp "$build/patella_${version}_$architecture.deb" "$work/files/"
  progress "$architecture: bill of materials"
  tools/release/sbom.py --build "$build" --package "$work/files/patella_${version}_$architecture.deb" \
    --epoch "$SOURCE_DATE_EPOCH" --out "$work/files/patella_${version}_$architecture.spdx.json"
}
for architecture in "${architectures[@]}"; do
  package "$architecture"
done

progress "checksums"
tools/release/seal.sh "$work/files" "patella $version" "$key"

mkdir -p "$out"
find "$out" -maxdepth 1 -type f \( -name 'patella[-_]*' -o -name 'SHA256SUMS*' \) -delete
cp "$work/files"/* "$out/"
progress "patella $version in $(realpath --relative-to="$root" "$out")"
(cd "$out" && cat SHA256SUMS)
