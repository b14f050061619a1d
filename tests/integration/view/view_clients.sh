#!/usr/bin/env bash
# Watches live runs with clients of other authors; see view_clients.mjs.
#
#   view_clients.sh PATELLA CONFIGURATION SOURCE_FOLDER NPM_FOLDER
set -euo pipefail
"$3/tools/npm_packages.sh" "$3/tests/support/npm" "$4" "nothing was held against programs of other authors"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
node "$3/tests/integration/view/view_clients.mjs" "$4" "$1" "$2" "$folder"
