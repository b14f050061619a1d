#!/bin/sh
# A function that code for a wider instruction set shares with other files may be kept by the linker for all of them,
# and then stops the program on a processor without it. So the kernel's files must define nothing of that kind.
#
#   kernel_symbols.sh NM LIBRARY
set -eu
shared=$("$1" -C "$2" | awk '
  /^[^ ]+\.o:$/ { kernel = /^kernel_avx/; count += kernel }
  kernel && $2 ~ /^[WVu]$/ && $3 !~ /^DW\.ref\./ { print }
  END { if (count == 0) print "no kernel in this library" }')
[ -z "$shared" ] || { echo "shared by the files of $2:"; echo "$shared"; exit 1; }
