# Cross build for arm64 with Debian's compiler and multiarch packages (tools/setup.sh --cross). The libraries stand in
# /usr/lib/aarch64-linux-gnu beside the host's own; headers and header-only packages are shared.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(ENV{PKG_CONFIG_LIBDIR} "/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig")

# Tests run under user emulation; the loader and libraries are those of the :arm64 packages.
find_program(PATELLA_QEMU_AARCH64 NAMES qemu-aarch64-static qemu-aarch64)
if(PATELLA_QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${PATELLA_QEMU_AARCH64}")
endif()
