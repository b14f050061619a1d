#!/usr/bin/env bash
# Joins the page of patella-view to one file, as a string of C++: the markup with styles and scripts in place of its marks,
# and uPlot among them where npm can be had.
#
#   join.sh PAGE_FOLDER NPM_FOLDER OUTPUT
set -euo pipefail
page=$1 npm=$2 output=$3

plots=()
if "$page/../../npm_packages.sh" "$page" "$npm" "the page of patella view is built without plots"; then
  plots=("$npm/node_modules/uplot")
fi
styles() {
  [ ${#plots[@]} -eq 0 ] || cat "${plots[0]}/dist/uPlot.min.css"
  cat "$page/page.css"
}
scripts() {
  if [ ${#plots[@]} -gt 0 ]; then
    echo "/*" && cat "${plots[0]}/LICENSE" && echo "*/"
    cat "${plots[0]}/dist/uPlot.iife.min.js"
  fi
  # One scope for all: a part uses what stands above it.
  for part in cdr history faults source_live source_recording leg charts histogram panels export main; do
    cat "$page/scripts/$part.js"
  done
}
{
  echo 'R"patella_page('
  while IFS= read -r line; do
    case $line in
      '<!-- styles -->') styles ;;
      '<!-- scripts -->') scripts ;;
      *) printf '%s\n' "$line" ;;
    esac
  done <"$page/page.html"
  echo ')patella_page"'
} >"$output.part"
mv "$output.part" "$output"
