#!/usr/bin/env bash
# Makes the documentation of the libraries' headers, HTML in build/api/html. Any warning of doxygen's is an error.
#
#   tools/checks/api.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/../..}"
PATELLA_API_FOLDER=build/api
PATELLA_VERSION=$(sed -nE 's/^project\(patella VERSION ([^ ]+) .*/\1/p' CMakeLists.txt)
export PATELLA_API_FOLDER PATELLA_VERSION
mkdir -p "$PATELLA_API_FOLDER"
doxygen docs/Doxyfile
[ -s "$PATELLA_API_FOLDER/html/index.html" ] || { echo "api.sh: doxygen made no $PATELLA_API_FOLDER/html/index.html" >&2; exit 1; }
echo "$(find "$PATELLA_API_FOLDER/html" -name '*.html' | wc -l) pages in $PATELLA_API_FOLDER/html, without a warning"
