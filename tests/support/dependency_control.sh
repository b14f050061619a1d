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
rm "$root/core/model/bad.hpp"

mkdir -p "$root/tools/diagnose/fit" "$root/tools/diagnose/verdict"
echo '#include "tools/diagnose/fit/model_fit.hpp"' >"$root/tools/diagnose/verdict/good.cpp"
expect 0 "one way"

echo '#include "tools/diagnose/verdict/verdict.hpp"' >"$root/tools/diagnose/fit/bad.cpp"
expect 1 "tools/diagnose/fit/bad.cpp:1: includes tools/diagnose/verdict/verdict.hpp"
rm "$root/tools/diagnose/fit/bad.cpp"

echo '#include <cstddef>' >"$root/tools/diagnose/thresholds.hpp"
echo '#include "tools/diagnose/thresholds.hpp"' >"$root/tools/diagnose/fit/judge.cpp"
expect 0 "one way"
echo '#include "tools/diagnose/fit/model_fit.hpp"' >"$root/tools/diagnose/thresholds.hpp"
expect 1 "tools/diagnose/thresholds.hpp:1: includes tools/diagnose/fit/model_fit.hpp"
echo '#include <cstddef>' >"$root/tools/diagnose/thresholds.hpp"

mkdir -p "$root/firmware_app/loop" "$root/firmware_app/recorder" "$root/tools/bench/tick"
echo '#include "firmware_app/loop/loop_sink.hpp"' >"$root/firmware_app/recorder/good.cpp"
echo '#include "firmware_app/loop/loop.hpp"' >"$root/tools/bench/tick/good.cpp"
expect 0 "one way"

echo '#include "firmware_app/recorder/recorder.hpp"' >"$root/firmware_app/loop/bad.cpp"
expect 1 "firmware_app/loop/bad.cpp:1: includes firmware_app/recorder/recorder.hpp"
rm "$root/firmware_app/loop/bad.cpp"

echo '#include "firmware_app/loop/loop.hpp"' >"$root/tools/diagnose/fit/bad.cpp"
expect 1 "tools/diagnose/fit/bad.cpp:1: includes firmware_app/loop/loop.hpp"
