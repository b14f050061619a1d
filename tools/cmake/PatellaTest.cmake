# patella_add_test(NAME name SOURCES a.cpp ... LIBRARIES lib ... [LABELS l ...] [NEEDS_DATA] [SANITIZERS s ...])
#
# One doctest executable, registered with CTest and built by the target patella_tests. With NEEDS_DATA, the whole test
# is reported as skipped (exit status 77) where PATELLA_DATA_DIR is absent.
#
# Every test is part of ordinary and of address-sanitizer builds. Builds with the thread or realtime sanitizer hold
# those that name it: tests that start threads, and tests that run loop code.
add_custom_target(patella_tests)

function(patella_add_test)
  cmake_parse_arguments(ARG "NEEDS_DATA" "NAME" "SOURCES;LIBRARIES;LABELS;SANITIZERS" ${ARGN})
  if(PATELLA_SANITIZER MATCHES "^(thread|realtime)$" AND NOT PATELLA_SANITIZER IN_LIST ARG_SANITIZERS)
    return()
  endif()
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} PRIVATE patella_test_main ${ARG_LIBRARIES})
  add_dependencies(patella_tests ${ARG_NAME})
  set(arguments "")
  if(ARG_NEEDS_DATA)
    set(arguments --needs-data)
  endif()
  add_test(NAME ${ARG_NAME} COMMAND ${ARG_NAME} ${arguments})
  set_tests_properties(${ARG_NAME} PROPERTIES SKIP_RETURN_CODE 77 LABELS "${ARG_LABELS}" TIMEOUT 300)
endfunction()
