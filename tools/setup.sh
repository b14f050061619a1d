#!/usr/bin/env bash
# Installs what Patella needs from the distribution's packages (Debian 12 or 13, amd64 or arm64, as root).
#
#   tools/setup.sh          to build and run
#   tools/setup.sh --test   also to test: second compiler, formatter, linter, reference libraries
set -euo pipefail

# doctest is here because configuring a build configures its tests too.
build_packages=(
  ca-certificates ccache cmake g++ git ninja-build pkg-config
  doctest-dev libboost-dev libceres-dev libcli11-dev libeigen3-dev libfftw3-dev libgpiod-dev libmd-dev libspdlog-dev
  libtomlplusplus-dev nlohmann-json3-dev
  gnuplot-nox
)
test_packages=(can-utils clang-format clang-tidy iproute2 libtorch-dev python3)
# Reported and left out where the distribution does not carry them; the tests that need them are then skipped.
optional_test_packages=(clang-22 libclang-rt-22-dev)

installed() { dpkg-query -W -f '${db:Status-Abbrev}' "$1" 2>/dev/null | grep -q '^ii'; }

wanted=("${build_packages[@]}")
optional=()
case "${1:-}" in
  "") ;;
  --test)
    wanted+=("${test_packages[@]}")
    optional=("${optional_test_packages[@]}")
    ;;
  *)
    echo "tools/setup.sh: unknown argument '$1', expected --test or nothing" >&2
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
apt-get update -qq
required=()
for package in "${missing[@]}"; do
  if printf '%s\n' "${optional[@]}" | grep -qx "$package" && ! apt-cache show "$package" >/dev/null 2>&1; then
    echo "tools/setup.sh: $package is not in this distribution; tests that need it will be skipped" >&2
  else
    required+=("$package")
  fi
done
apt-get install -y -qq --no-install-recommends "${required[@]}" >/dev/null
