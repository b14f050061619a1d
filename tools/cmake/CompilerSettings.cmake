# One set of compiler rules for every target of the project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # Two checkouts of the same sources share their objects. What a source includes is known from the compiler's dependency
  # files: a source that is not in the cache is not preprocessed once more to find out, which takes a tenth of its time.
  # Headers are hashed once, not for each source that includes them: that is four fifths of the time of a hit.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1 CCACHE_PCH_EXTSUM=1
    CCACHE_INODECACHE=1 CCACHE_SLOPPINESS=pch_defines,time_macros "${CCACHE_PROGRAM}")
endif()

# What an installed library asks of those who link it (tools/cmake/InstallLibraries.cmake): headers, the language, and one
# alignment of Eigen's matrices, whatever vector instructions they build for.
add_library(patella_settings INTERFACE)
target_include_directories(patella_settings INTERFACE
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" "$<INSTALL_INTERFACE:include/patella>")
target_compile_features(patella_settings INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
target_compile_definitions(patella_settings INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_STATIC_ALIGN_BYTES=16>)
# How this project compiles.
add_library(patella_compiler_flags INTERFACE)
target_link_libraries(patella_settings INTERFACE $<BUILD_INTERFACE:patella_compiler_flags>)
target_compile_options(patella_compiler_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual -Wnull-dereference -Wformat=2 -Werror
  # A fused multiply-add where the compiler feels like it would make logs differ between builds.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports false positives of these inside Eigen and libstdc++ at -O2 and under sanitizers.
  target_compile_options(patella_compiler_flags INTERFACE
    -Wno-maybe-uninitialized -Wno-null-dereference -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    # Notes about a calling convention that changed with GCC 10.1; nothing here is linked with older C++ objects.
    target_compile_options(patella_compiler_flags INTERFACE -Wno-psabi)
  endif()
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # doctest's __COUNTER__ is an extension to clang 22.
  target_compile_options(patella_compiler_flags INTERFACE -Wno-unknown-warning-option -Wno-c2y-extensions)
  # A precompiled header with the time of its making in it would be another one for ccache each time.
  target_compile_options(patella_compiler_flags INTERFACE "SHELL:-Xclang -fno-pch-timestamp")
  # Clang finds the precompiled one beside the header. ccache makes this path a relative one, which it does not behind -Xclang.
  set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include <PCH_HEADER>)
endif()

set(PATELLA_SANITIZER "" CACHE STRING "address (with undefined), thread, realtime, fuzzer, or empty")
set_property(CACHE PATELLA_SANITIZER PROPERTY STRINGS "" address thread realtime fuzzer)
if(PATELLA_SANITIZER STREQUAL "address")
  set(_sanitize -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -O1)
elseif(PATELLA_SANITIZER STREQUAL "thread")
  set(_sanitize -fsanitize=thread -O1)
elseif(PATELLA_SANITIZER STREQUAL "realtime")
  set(_sanitize -fsanitize=realtime -O1)
elseif(PATELLA_SANITIZER STREQUAL "fuzzer")
  set(_sanitize -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -O1)
elseif(NOT PATELLA_SANITIZER STREQUAL "")
  message(FATAL_ERROR "PATELLA_SANITIZER is '${PATELLA_SANITIZER}', expected address, thread, realtime, fuzzer or empty")
endif()
if(_sanitize)
  include(FastLinker)
  add_compile_options(${_sanitize})
  add_link_options(${_sanitize} ${patella_fast_link})
  add_compile_definitions(PATELLA_SANITIZER_${PATELLA_SANITIZER}=1)
endif()

# Line numbers are enough for a stack trace, and far quicker to build than all that a debugger could ask for.
if(CMAKE_BUILD_TYPE STREQUAL "RelWithDebInfo")
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1 -DNDEBUG")
elseif(PATELLA_SANITIZER)
  set(CMAKE_CXX_FLAGS_DEBUG "-g1")
endif()
