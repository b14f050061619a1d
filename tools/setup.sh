#!/usr/bin/env bash
# Installs what Patella needs from the distribution's packages (Debian 12 or 13, amd64 or arm64, as root).
#
#   tools/setup.sh          to build and run
#   tools/setup.sh --test   also to test: second compiler, formatter, linter, reference libraries, browser
#   tools/setup.sh --cross  also to build for arm64 and to run that under emulation; exit status 77 where that cannot be had
set -euo pipefail

. "$(dirname "$0")/packages.sh"

installed() { dpkg-query -W -f '${db:Status-Abbrev}' "$1" 2>/dev/null | grep -q '^ii'; }

wanted=("${build_packages[@]}")
optional=()
case "${1:-}" in
  "") ;;
  --test)
    wanted+=("${test_packages[@]}")
    optional=("${optional_test_packages[@]}")
    # For the page of patella view. Who has npm from elsewhere keeps that: the distribution's would not install beside it.
    command -v npm >/dev/null || optional+=(nodejs npm)
    ;;
  --cross)
    wanted+=("${cross_packages[@]}")
    [ "$(dpkg --print-architecture)" = arm64 ] || wanted+=("${cross_libraries[@]}")
    ;;
  *)
    echo "tools/setup.sh: unknown argument '$1', expected --test, --cross or nothing" >&2
    exit 2
    ;;
esac

missing=()
for package in "${wanted[@]}" "${optional[@]}"; do
  installed "$package" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

if [ "$(id -u)" -ne 0 ]; then
  echo "tools/setup.sh: needs root to install: ${missing[*]}" >&2
  exit 1
fi
export DEBIAN_FRONTEND=noninteractive
echo "Installing: ${missing[*]}"
if [ "${1:-}" = --cross ] && [ "$(dpkg --print-architecture)" != arm64 ]; then
  dpkg --add-architecture arm64
fi
apt-get update -qq
if [ "${1:-}" = --cross ] &&
  ! apt-get -s -qq --no-remove --no-install-recommends install "${missing[@]}" >/dev/null 2>&1; then
  echo "tools/setup.sh: cannot have ${missing[*]} without removing packages of this machine; nothing was installed" >&2
  exit 77
fi
required=()
for package in "${missing[@]}"; do
  if printf '%s\n' "${optional[@]}" | grep -qx "$package" && ! apt-cache show "$package" >/dev/null 2>&1; then
    echo "tools/setup.sh: $package is not in this distribution; tests that need it will be skipped" >&2
  else
    required+=("$package")
  fi
done
apt-get install -y -qq --no-install-recommends "${required[@]}" >/dev/null
