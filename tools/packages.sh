# The distribution's packages by what needs them; sourced.

# Build tools and headers that serve every architecture. doctest is here because configuring a build configures its tests too.
portable_packages=(ccache cmake doctest-dev libboost-dev libcli11-dev libeigen3-dev ninja-build nlohmann-json3-dev pkg-config)
# Libraries that the programs of the rig are linked to.
linked_packages=(libedf-dev libgpiod-dev libmd-dev libspdlog-dev libtomlplusplus-dev liburdfdom-dev libzstd-dev zlib1g-dev)
build_packages=("${portable_packages[@]}" "${linked_packages[@]}" ca-certificates g++ git gnuplot-nox libceres-dev
  libfftw3-dev libmatio-dev)
# libtorch multiplies with whatever BLAS is there; the one that it brings along takes three times as long, and of OpenBLAS only
# this kind keeps to the number of threads that libtorch is told.
test_packages=(can-utils chromium clang-format clang-tidy debootstrap doxygen iproute2 libopenblas0-openmp liborocos-kdl-dev
  libtorch-dev lld minisign python3 python3-can python3-torch tshark)
# Reported and left out where the distribution does not carry them; the tests that need them are then skipped.
optional_test_packages=(clang-22 clang-tidy-22 libclang-rt-22-dev python3-mne)

# The cross compiler brings its own C library; crossbuild-essential would upgrade and remove packages of the host.
cross_compiler=g++-aarch64-linux-gnu
cross_packages=("$cross_compiler" cpio kmod mmdebstrap python3 qemu-system-arm qemu-user-static)
cross_libraries=("${linked_packages[@]/%/:arm64}")
