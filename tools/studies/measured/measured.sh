#!/usr/bin/env bash
# Diagnoses other people's recordings, whose missing effects nobody put there: a drive axis (EMPS), a two-link arm with
# CAN drives, the passive knee of a person. Prints the answers, and what the literature counts beside them.
#
#   tools/studies/measured/measured.sh --data DIR --out DIR [--bin BUILD]      DIR: with emps, double_pendulum, passive_knee
set -euo pipefail
cd "$(dirname "$0")/../../.."

refuse() {
  echo "measured.sh: $1, expected $2" >&2
  exit 2
}
# OPTION WHAT VALUE...: there is a value.
needs() { [ $# -gt 2 ] && [ -n "$3" ] || refuse "$1: no value" "$2"; }

bin=build/release
data=
out=
while [ $# -gt 0 ]; do
  case "$1" in
    --bin) needs "$1" "a build folder" "${@:2}"; bin=$2; shift 2 ;;
    --data) needs "$1" "a folder" "${@:2}"; data=$2; shift 2 ;;
    --out) needs "$1" "a folder" "${@:2}"; out=$2; shift 2 ;;
    *) refuse "unknown argument '$1'" "--bin BUILD, --data DIR or --out DIR" ;;
  esac
done
[ -n "$data" ] || refuse "--data: missing" "a folder with emps, double_pendulum and passive_knee"
[ -n "$out" ] || refuse "--out: missing" "a folder for the results"
for part in emps double_pendulum passive_knee; do
  [ -d "$data/$part" ] || refuse "--data: there is no folder '$data/$part'" "a folder with emps, double_pendulum and passive_knee"
done
[ -x "$bin/tools/diagnose/patella-diagnose" ] || refuse "--bin: '$bin' has no patella-diagnose" "a folder that it was built in"

maps=tools/diagnose/maps
figures=$bin/tools/studies/measured/patella-study-measured
headline() { printf '\n== %s\n' "$*"; }

# NAME and the arguments of a diagnosis; what it says of its progress goes beside its results.
diagnose() {
  local folder=$out/$1
  shift
  mkdir -p "$out"
  "$bin/tools/diagnose/patella-diagnose" "$@" --out "$folder" 2>"$folder.txt" || { cat "$folder.txt" >&2; exit 1; }
}

emps=(--data "$data/emps/emps.csv" --columns "$maps/emps.toml")
headline "EMPS, told of its mass only"
diagnose emps_inertia --model $maps/emps_inertia.toml "${emps[@]}"
headline "EMPS, told of its mass and of symmetric friction"
diagnose emps_symmetric --model $maps/emps_symmetric.toml "${emps[@]}"
for torque in sampled held; do
  headline "EMPS, the measure of its benchmark, force $torque (published: symmetric friction 4.08, asymmetric 3.11)"
  "$figures" emps "${emps[@]}" --torque $torque --models tools/studies/measured/emps_published.toml $maps/emps_inertia.toml \
    $maps/emps_symmetric.toml "$out"/emps_{inertia,symmetric}/model.extended.toml
done

arm=$data/double_pendulum
arm_map=(--columns "$maps/double_pendulum.toml")
headline "Two-link arm, told of its rigid body; runs 1 and 2, judged by run 3"
diagnose double_pendulum --model firmware_app/config/models/double_pendulum.toml "${arm_map[@]}" \
  --data "$arm/run_1.csv" "$arm/run_2.csv" --holdout "$arm/run_3.csv"
headline "Two-link arm: how late its drives are, measured against commanded torque"
"$figures" timing "${arm_map[@]}" --data "$arm"/run_{1,2,3}.csv

knee=$data/passive_knee/silder_2007.csv
headline "Passive knee at rest, told of no tissue, one posture of hip and ankle"
diagnose passive_knee --model $maps/passive_knee_model.toml --columns $maps/passive_knee.toml --data "$knee"
headline "Passive leg at rest, told of no tissue, two postures of the hip, the ankle in one"
diagnose passive_leg_ankle_20 --model $maps/passive_leg_model.toml --columns $maps/passive_leg_ankle_20.toml \
  --data "$knee"
headline "Passive leg at rest, told of no tissue, all postures, the ankle's not told"
diagnose passive_leg --model $maps/passive_leg_model.toml --columns $maps/passive_leg.toml --data "$knee"
printf '\nReports: %s\n' "$out/*/report.html"
