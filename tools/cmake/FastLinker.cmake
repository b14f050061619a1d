# patella_fast_link: options that link with LLVM's linker where that is there, in a quarter of the time that the
# distribution's takes. For what does not ship: tests, studies, builds with a sanitizer.
find_program(PATELLA_LLD ld.lld)
mark_as_advanced(PATELLA_LLD)
set(patella_fast_link "")
if(PATELLA_LLD AND NOT CMAKE_CROSSCOMPILING)
  set(patella_fast_link -fuse-ld=lld)
endif()
