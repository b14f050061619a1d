#!/usr/bin/env bash
# Fails and shows the places where a source differs from what clang-format makes of it.
set -euo pipefail
cd "$(dirname "$0")/../.."
find core drivers sim firmware_app tools tests docs/examples \( -name '*.hpp' -o -name '*.cpp' \) -print0 |
  xargs -0 clang-format --dry-run --Werror
echo "formatting is right"
