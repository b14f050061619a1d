# Sourced. Puts the shared libraries that arm64 executables need beside them.
#
# copy_libraries ROOT DIR...: for every ELF file below ROOT, copies the libraries it names, and what those name in
# turn, from the first DIR that has them into ROOT/lib/aarch64-linux-gnu, and the loader to where executables expect it.
copy_libraries() {
  local root=$1 library directory changed=true
  shift
  mkdir -p "$root/lib/aarch64-linux-gnu"
  while $changed; do
    changed=false
    for library in $(find "$root" -type f -not -name '*.ko' -print0 | xargs -0 readelf -d 2>/dev/null |
        sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u); do
      [ ! -e "$root/lib/aarch64-linux-gnu/$library" ] || continue
      for directory in "$@"; do
        if [ -e "$directory/$library" ]; then
          cp -L "$directory/$library" "$root/lib/aarch64-linux-gnu/"
          changed=true
          continue 2
        fi
      done
      echo "tools/board: no $library for arm64 in $*" >&2
      return 1
    done
  done
  if [ -e "$root/lib/aarch64-linux-gnu/ld-linux-aarch64.so.1" ]; then
    ln -sf aarch64-linux-gnu/ld-linux-aarch64.so.1 "$root/lib/ld-linux-aarch64.so.1"
  fi
}

# make_cpio ROOT FILE: an initramfs of everything below ROOT, the same bytes for the same contents. It is not compressed: the
# board unpacks it instruction by instruction, emulated.
make_cpio() {
  find "$1" -exec touch -h -d @0 {} +
  (cd "$1" && find . -mindepth 1 -print0 | LC_ALL=C sort -z |
    cpio --null --quiet --reproducible --create --format=newc --owner=0:0) >"$2.new"
  mv "$2.new" "$2"
}
