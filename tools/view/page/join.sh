#!/usr/bin/env bash
# Joins the page of patella-view, as strings of C++ that follow each other: the markup with styles and scripts in place of its
# marks, and uPlot among them where npm can be had. A string of C++ holds no more than 64 KiB everywhere.
#
#   join.sh PAGE_FOLDER NPM_FOLDER OUTPUT
set -euo pipefail
page=$1 npm=$2 output=$3

plots=()
if "$page/../../npm_packages.sh" "$page" "$npm" "the page of patella view is built without plots"; then
  plots=("$npm/node_modules/uplot")
fi
# What comes in, as a string.
string() { printf 'R"patella_page(' && cat && printf ')patella_page",\n'; }
styles() {
  [ ${#plots[@]} -eq 0 ] || string <"${plots[0]}/dist/uPlot.min.css"
  string <"$page/page.css"
}
scripts() {
  if [ ${#plots[@]} -gt 0 ]; then
    { echo "/*" && cat "${plots[0]}/LICENSE" && echo "*/"; } | string
    string <"${plots[0]}/dist/uPlot.iife.min.js"
  fi
  # One scope for all: a part uses what stands above it.
  for part in cdr history faults source_live source_recording leg charts histogram panels export main; do
    string <"$page/scripts/$part.js"
  done
}
while IFS= read -r line; do
  case $line in
    '<!-- styles -->') styles ;;
    '<!-- scripts -->') scripts ;;
    *) printf '%s\n' "$line" | string ;;
  esac
done <"$page/page.html" >"$output.part"
mv "$output.part" "$output"
