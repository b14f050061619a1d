#!/usr/bin/env bash
# From runs of the loop to a network that the loop runs: trained, killed on the way and resumed, scored on what it has
# not seen and refused on what it has.
#
#   train.sh PATELLA PATELLA_TRAIN CONFIG
set -euo pipefail
patella=$1 train=$2 config=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "train.sh: $*" >&2; exit 1; }

for seed in 1 2 3; do
  "$patella" run --config "$config" --clock virtual --duration 6 --seed $seed --out "$folder/run$seed" >/dev/null
done
# In the shell's own place, so that who kills it kills the training.
fit() {
  exec "$train" fit --config "$config" --data "$folder"/run{1,2} --out "$folder/$1.safetensors" \
    --split chronological --test-share 0.3 --validation-share 0.2 --rate-Hz 50 \
    --hidden 8 --channels 8 --heads 2 --window 8 --batch 2 --sequence-steps 48 --burn-in 8 --linear-lags 0,1,5 --epochs 25 --patience 25
}

(fit whole) >/dev/null
fit killed >/dev/null 2>&1 & pid=$!
while [ ! -e "$folder/killed.safetensors.checkpoint" ] && kill -0 $pid 2>/dev/null; do sleep 0.02; done
kill -9 $pid 2>/dev/null || true
wait $pid 2>/dev/null || true
(fit killed) >"$folder/resumed.txt" 2>&1
cmp "$folder/whole.safetensors" "$folder/killed.safetensors" || fail "resumed after kill -9, the weights differ"
[ ! -e "$folder/killed.safetensors.checkpoint" ] || fail "the checkpoint is left behind"
[ -s "$folder/whole.png" ] || fail "no picture of the learning curves"
grep -q '"sha256":"' <(head -c 8000 "$folder/whole.safetensors" | tr -d '\\') || fail "the model card lacks its data"

"$train" score --config "$config" --weights "$folder/whole.safetensors" --data "$folder/run3" >"$folder/score.txt"
grep -q 'joint 2 mean absolute' "$folder/score.txt" || fail "no score on a recording that was not trained on"
cp -r "$folder/run1" "$folder/copy"
if "$train" score --config "$config" --weights "$folder/whole.safetensors" --data "$folder/copy" 2>"$folder/refusal.txt"; then
  fail "a score was given on data that were trained on"
fi
grep -q 'the network was trained on it' "$folder/refusal.txt" || fail "refused for another reason: $(cat "$folder/refusal.txt")"

"$patella" run --config "$config" --clock virtual --duration 3 --seed 4 --weights "$folder/whole.safetensors" \
  --out "$folder/loop" >"$folder/loop.txt" 2>&1
grep -q 'estimate| of the network' "$folder/loop.txt" || fail "the loop shows no estimate of the network"
grep -q 'heap operations 0' "$folder/loop.txt" || fail "the loop touched the heap"
grep -q 'linear path compensates' "$folder/loop.txt" && fail "warned of a network that does not compensate"
sed -e 's#"sampler"$#"network"#' -e "s#= \"\(models\|can\)/#= \"$(realpath "$(dirname "$config")")/\1/#" "$config" >"$folder/compensating.toml"
"$patella" run --config "$folder/compensating.toml" --clock virtual --duration 1 --weights "$folder/whole.safetensors" \
  --out "$folder/compensating" >"$folder/compensating.txt" 2>&1 || fail "$(cat "$folder/compensating.txt")"
grep -q 'whole.safetensors: a network with a linear path compensates' "$folder/compensating.txt" ||
  fail "no warning where a network compensates that never saw one do so: $(cat "$folder/compensating.txt")"
# Other keys in place of the seal's make weights from elsewhere of them.
sed 's/"seal/"deal/g' "$folder/whole.safetensors" >"$folder/foreign.safetensors"
use() { "$patella" run --config "$config" --clock virtual --duration 0.1 --weights "$folder/foreign.safetensors" --out "$folder/use$1" 2>&1; }
use 1 | grep -q 'foreign.safetensors: no digest: damaged weights cannot be told' || fail "no warning of weights without a digest"
"$train" seal "$folder/foreign.safetensors" | grep -qE 'digest [0-9a-f]{64}$' || fail "seal tells no digest"
use 2 | grep -q 'no digest' && fail "warned of weights that seal was given"
"$train" seal "$folder/foreign.safetensors" | grep -q 'has a digest already' || fail "seal does not see its own digest"
lags() {
  rm -f "$folder/lags.safetensors"
  "$train" fit --config "$config" --data "$folder"/run{1,2} --out "$folder/lags.safetensors" --split recording \
    --validation-share 0 --test-share 0 --rate-Hz 50 --hidden 4 --channels 4 --heads 1 --epochs 1 --sequence-steps 96 "$@" >/dev/null
  head -c 8000 "$folder/lags.safetensors" | tr -d '\\' | grep -ao '"linear_lags":"[0-9,]*"' || echo none
}
[ "$(lags)" = '"linear_lags":"0,1,2,3,5,8,12,18,26,36"' ] || fail "no linear path unless told otherwise: $(lags)"
[ "$(lags --linear-lags none)" = none ] || fail "a linear path against --linear-lags none"
[ "$(lags --features paper)" = none ] || fail "a linear path through time"

if "$train" fit --config "$config" --data "$folder/run1" --heads 3 --out "$folder/x.safetensors" 2>"$folder/wrong.txt"; then
  fail "a wrong argument was taken"
fi
grep -q 'heads: value 3' "$folder/wrong.txt" || fail "the wrong argument is not named"

# A rate in words is the rate that the loop counts with.
"$train" fit --config "$config" --data "$folder/run1" --out "$folder/thirds.safetensors" --rate-Hz 66.7 --split recording \
  --validation-share 0 --test-share 0 --hidden 4 --channels 4 --heads 1 --epochs 1 --sequence-steps 96 >/dev/null
"$patella" run --config "$config" --clock virtual --duration 0.1 --weights "$folder/thirds.safetensors" --out "$folder/thirds" \
  >"$folder/thirds.txt" 2>&1 || fail "a network of 66.7 Hz is not taken: $(cat "$folder/thirds.txt")"

# What cannot be written is refused before the training, and no picture is drawn over the weights.
refused() { # WORDS OPTION...
  if "$train" fit --config "$config" --data "$folder/run1" "${@:2}" >"$folder/said.txt" 2>&1; then fail "taken: ${*:2}"; fi
  grep -q "$1" "$folder/said.txt" || fail "no '$1': $(cat "$folder/said.txt")"
  grep -q 'steps to train on' "$folder/said.txt" && fail "refused only after the recordings were read: ${*:2}"
  return 0
}
refused 'cannot be replaced' --out "$folder"
refused 'cannot be created' --out "$folder/y.safetensors" --curves "$folder/none/y.png"
refused 'a picture of its own' --out "$folder/y.png"
