# patella_add_test(NAME name SOURCES a.cpp ... LIBRARIES lib ... [LABELS l ...] [NEEDS_DATA])
#
# One doctest executable, registered with CTest. With NEEDS_DATA, the whole test is reported as
# skipped (exit status 77) where PATELLA_DATA_DIR is absent.
function(patella_add_test)
  cmake_parse_arguments(ARG "NEEDS_DATA" "NAME" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} PRIVATE patella_test_main ${ARG_LIBRARIES})
  set(arguments "")
  if(ARG_NEEDS_DATA)
    set(arguments --needs-data)
  endif()
  add_test(NAME ${ARG_NAME} COMMAND ${ARG_NAME} ${arguments})
  set_tests_properties(${ARG_NAME} PROPERTIES SKIP_RETURN_CODE 77 LABELS "${ARG_LABELS}" TIMEOUT 300)
endfunction()
