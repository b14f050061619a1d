#!/usr/bin/env bash
# Holds the rooms of the diagnosis that decide against tools/diagnose/thresholds.hpp: no other file of theirs defines a
# number of its own, but for the numerics below, and docs/diagnosis.md has the table of the header.
# Numbers without a name, and constants that are no double, are not looked at.
#
#   tools/checks/thresholds.sh [ROOT]         the check
#   tools/checks/thresholds.sh --table [ROOT] the table for docs/diagnosis.md
set -euo pipefail
table=false
if [ "${1:-}" = --table ]; then
  table=true
  shift
fi
root=${1:-$(dirname "$0")/../..}
cd "$root"
header=tools/diagnose/thresholds.hpp
document=docs/diagnosis.md
status=0

# Question, namespace and values, one row a question.
rows() {
  echo '| question | `namespace` | thresholds |'
  echo '|---|---|---|'
  awk '/^\/\/\/ .*\?$/ { question = substr($0, 5) }
    /^namespace [a-z_]+ \{/ { room = $2; list = "" }
    /^inline constexpr / { sub(";.*", "", $0); name = $4; value = $0; sub("^[^=]*= ", "", value)
                           list = list (list == "" ? "" : ", ") name " " value }
    /^}  \/\/ namespace [a-z_]+$/ { print "| " question " | `" room "` | " list " |" }' "$header"
}

if $table; then
  rows
  exit 0
fi

fail() {
  echo "$1" >&2
  status=1
}

# Filters, grids, floors of divisions, windows, units and pictures: ROOM/NAME.
numerics="
fit/kDifference fit/kDifference_m fit/kFarthestLogarithm fit/kFarthestSlide_m fit/kLargestLogarithm fit/kLargest_rad fit/kNextToNothing fit/kRelativeStep
fit/kMomentRounding fit/kUnit_kg fit/kNoFurtherGain fit/kRounding fit/kSimulationWindow_s
checks/kAny checks/kAside_m checks/kDegree checks/kDegrees checks/kDelayGrid_s checks/kLongestDelay_s checks/kLongestLag_s
checks/kFirstStep_rad checks/kLastStep_rad checks/kMillisecond checks/kPerResolution checks/kPerTurnDegrees checks/kResolution_s checks/kRidge checks/kSettled checks/kTurn checks/kTurns
search/kDeviations95 search/kFastestChange_Hz search/kFirstSteps search/kFullySpanned search/kLastSteps search/kLeastVariance_Nm2
search/kNarrowest search/kNearlySpanned search/kOffTheBound search/kSlowest_rad_s search/kSpanned search/kSpannedExactly search/kStep search/kUnknownLogarithm
verdict/kBand_Hz verdict/kFractionOfBin verdict/kIndependence verdict/kLeast verdict/kLineWidth_Hz
verdict/kNeighbourhood_Hz verdict/kNever verdict/kNextToNone verdict/kNone verdict/kRate_Hz verdict/kRidge
verdict/kSmall verdict/kSmoothing_Hz verdict/kStep verdict/kStep_Hz verdict/kStretch_s verdict/kSwing_s
"
used=""
for room in fit checks search verdict; do
  [ -d "tools/diagnose/$room" ] || continue
  while IFS=: read -r file line name; do
    [ -n "$file" ] || continue
    used+=" $room/$name "
    case " ${numerics//$'\n'/ } " in
      *" $room/$name "*) ;;
      *) fail "$file:$line: $name is no numerics that $0 knows; what decides stands in $header" ;;
    esac
  done < <(grep -rnoE 'constexpr double k\w+' "tools/diagnose/$room" --include='*.hpp' --include='*.cpp' |
    sed -E 's/constexpr double //' | sort || true)
done
if [ -d tools/diagnose/verdict ]; then
  for name in $numerics; do
    [[ $used == *" $name "* ]] || fail "$0: $name is in no file of tools/diagnose/${name%/*}"
  done
fi

diff <(rows) <(sed -n '/^| question | `namespace` |/,/^$/p' "$document" | sed '/^$/d') >&2 ||
  fail "$document: its table of thresholds is not that of $header; tools/checks/thresholds.sh --table prints it"

[ "$status" -ne 0 ] || echo "$(grep -c '^inline constexpr ' "$header") thresholds decide, all of them in $header"
exit "$status"
