#!/usr/bin/env bash
# Holds MCAP files of the recorder, of patella-convert and of a recovery against the reference reader (npm @mcap/core) and
# the files that the run left beside them.
#
#   read_with_clients.sh PATELLA PATELLA_CONVERT SOURCE_FOLDER NPM_FOLDER
set -euo pipefail
patella=$1 convert=$2 source=$3 npm=$4
"$source/tools/npm_packages.sh" "$source/tests/support/npm" "$npm" "nothing was held against programs of other authors"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

configuration=$source/firmware_app/config
sed -E "s#= \"([a-z]+/[^\"]+)\"#= \"$configuration/\1\"#" "$configuration/adult.toml" >"$folder/run.toml"
printf '\n[recorder]\nmcap = true\n' >>"$folder/run.toml"
for run in a b; do
  "$patella" run --config "$folder/run.toml" --clock virtual --duration 3 --out "$folder/$run" >/dev/null
done
cmp "$folder/a/run.mcap" "$folder/b/run.mcap"
echo "ok    the same run gives the same bytes"

inputs=("$folder/run.toml" "$configuration/models/adult.toml" "$configuration/can/patella.toml" "$source/drivers/can/patella.dbc")
"$convert" --mcap "$folder/a" --out "$folder/converted.mcap" $(printf -- '--attach %s ' "${inputs[@]}")
size=$(stat -c %s "$folder/a/run.mcap")
head -c $((size * 2 / 3)) "$folder/a/run.mcap" >"$folder/cut.mcap"
"$convert" --recover "$folder/cut.mcap" --out "$folder/recovered.mcap"
"$convert" --recover "$folder/a/run.mcap" --out "$folder/copied.mcap"
if "$convert" --mcap "$folder/a" --attach "$configuration/double_pendulum.toml" --out "$folder/no.mcap" 2>"$folder/refusal"; then
  echo "FAILS a file that the run was not configured from is attached" && exit 1
fi
grep -q "is not among the inputs" "$folder/refusal"
[ ! -e "$folder/no.mcap" ]
echo "ok    a file that the run was not configured from is refused"

node "$source/tests/integration/mcap/read_with_clients.mjs" "$npm" "$folder/a" \
  "$folder/a/run.mcap=whole" "$folder/copied.mcap=whole" "$folder/converted.mcap=whole" "$folder/recovered.mcap=part" -- "${inputs[@]}"
