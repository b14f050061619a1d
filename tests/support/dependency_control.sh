#!/usr/bin/env bash
# The check of dependencies must find what is wrong, and only that: dependency_control.sh CHECK
set -euo pipefail
. "$(dirname "$0")/check_control.sh" "$1"
mkdir -p "$root/core/model" "$root/drivers" "$root/sim"

echo '#include "core/types.hpp"' >"$root/drivers/good.cpp"
printf '#include <vector>\n#include <Eigen/Core>\n' >"$root/core/good.hpp"
expect 0 "one way"

echo '#include "sim/plant.hpp"' >"$root/drivers/bad.cpp"
expect 1 "drivers/bad.cpp:1: includes sim/plant.hpp"
rm "$root/drivers/bad.cpp"

printf '// comment\n#include <toml++/toml.h>\n' >"$root/core/model/bad.hpp"
expect 1 "core/model/bad.hpp:2: includes toml++/toml.h"
