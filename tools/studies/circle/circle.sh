#!/usr/bin/env bash
# The closed circle, in virtual time: the loop records a motion on a rig that hides an effect from the loop's model,
# patella-diagnose finds the effect, and the loop runs with the extended model on a motion that was not recorded,
# beside the plain model and the rig's own. Prints what was diagnosed and what each model left over on that motion.
#
#   tools/studies/circle/circle.sh --bin BUILD --out DIR [RIG_MODEL.toml ...]      default: every model beside this script
#
# A rig of the kind serial_chain is of two legs in one loop.
#
# Nothing but the loop's model differs between the three runs: one rig, one reference, one seed.
set -euo pipefail
cd "$(dirname "$0")/../../.."

refuse() {
  echo "circle.sh: $1, expected $2" >&2
  exit 2
}
# OPTION WHAT VALUE...: there is a value.
needs() { [ $# -gt 2 ] && [ -n "$3" ] || refuse "$1: no value" "$2"; }

bin=build/release
out=
rigs=()
while [ $# -gt 0 ]; do
  case "$1" in
    --bin) needs "$1" "a build folder" "${@:2}"; bin=$2; shift 2 ;;
    --out) needs "$1" "a folder" "${@:2}"; out=$2; shift 2 ;;
    -*) refuse "unknown argument '$1'" "--bin BUILD, --out DIR or models" ;;
    *) rigs+=("$1"); shift ;;
  esac
done
[ -n "$out" ] || refuse "--out: missing" "a folder for the results"
[ ${#rigs[@]} -gt 0 ] || rigs=(tools/studies/circle/*.toml tools/studies/circle/two_legs/*.toml)
for rig in "${rigs[@]}"; do
  [ -f "$rig" ] || refuse "there is no file '$rig'" "models of rigs, TOML"
done
[ -x "$bin/firmware_app/patella" ] || refuse "--bin: '$bin' has no patella" "a folder that it was built in"

# Configuration of the loop, its model, the motion that is not recorded and the patient's push, for the rig of this round.
choose() {
  if grep -q '^kind = "serial_chain"' "$rig"; then
    config=firmware_app/config/two_legs_identification.toml
    model=firmware_app/config/models/two_legs.toml
    unseen=firmware_app/config/references/two_legs_unseen.toml
    joints=(q1 q2 q3 q4)
    person=()
  else
    config=firmware_app/config/identification.toml
    model=firmware_app/config/models/adult.toml
    unseen=firmware_app/config/references/unseen.toml
    joints=(hip knee)
    # What the patient's 1.5 N make of torque: d̂ rms of the loop that has the rig's own model.
    person=(--person 1.1,0.6)
  fi
}

# The loop on the rig of this round: FOLDER and what differs from the configuration.
run() {
  local folder=$1
  shift
  mkdir -p "$(dirname "$folder")"
  "$bin/firmware_app/patella" run --config "$config" --clock virtual --rig-model "$rig" "$@" --out "$folder" \
    >"$folder.txt" || { cat "$folder.txt" >&2; exit 1; }
}

# Number JOINT of the array KEY in a run's summary.
number() {
  awk -v key="\"$2\":" -v joint="$3" '
    $1 == key { inside = 1; next }
    inside && ++n == joint { sub(",", "", $1); print $1; exit }' "$1/summary.json"
}

row() {
  local text=$1 key=$2 joint run
  shift 2
  for joint in $(seq "${#joints[@]}"); do
    for run in "$@"; do
      number "$run" "$key" "$joint"
    done
  done | awk -v text="$text" '
    { line = line (NR > 1 && NR % 3 == 1 ? "   " : "") sprintf("%10.4f", $1) }
    END { printf "  %-34s%s\n", text, line }'
}

for rig in "${rigs[@]}"; do
  name=$(basename "$rig" .toml)
  folder=$out/$name
  choose
  printf '\n%s\n' "$name"
  sed -n '/^#/!q; s/^# /  hidden: /p' "$rig" | sed '2,$s/hidden: //'
  run "$folder/recorded"
  "$bin/tools/diagnose/patella-diagnose" --model "$model" --data "$folder/recorded" --out "$folder/diagnosis" \
    "${person[@]}" 2>"$folder/diagnosis.txt" | sed 's/^/  /' || { cat "$folder/diagnosis.txt" >&2; exit 1; }
  run "$folder/plain" --reference "$unseen" --seed 2
  run "$folder/extended" --reference "$unseen" --seed 2 --model "$folder/diagnosis/model.extended.toml"
  run "$folder/truth" --reference "$unseen" --seed 2 --model "$rig"
  printf '  %-29s' ""
  for joint in "${joints[@]}"; do
    printf '%13s%10s%10s' "$joint: plain" extended truth
  done
  printf '\n'
  runs=("$folder/plain" "$folder/extended" "$folder/truth")
  row "residual d̂, N·m rms" d_hat_rms_Nm "${runs[@]}"
  row "unknown f̂_u, rad/s² rms" f_s_filtered_rms_rad_s2 "${runs[@]}"
  row "tracking error, rad rms" tracking_rms_rad "${runs[@]}"
done
