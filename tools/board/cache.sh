# Sourced. The folder where packages, images and a Debian 13 are kept, 0.6 GB: one for all checkouts of a user. It may be
# removed at any time.
board_cache=${PATELLA_BOARD_CACHE:-${XDG_CACHE_HOME:-~/.cache}/patella/board}
mkdir -p "$board_cache"
board_cache=$(cd "$board_cache" && pwd)
