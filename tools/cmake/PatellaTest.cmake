# patella_add_test(NAME name SOURCES a.cpp ... LIBRARIES lib ... [LABELS l ...] [NEEDS_DATA] [LONG]
#                  [SANITIZERS s ...])
#
# One doctest executable, registered with CTest and built by the target patella_tests. With NEEDS_DATA, the whole test
# is reported as skipped (exit status 77) where PATELLA_DATA_DIR is absent.
#
# Every test is part of ordinary and of address-sanitizer builds. Builds with the thread or realtime sanitizer hold
# those that name it: tests that start threads, and tests that run loop code. LONG tests would take minutes to compile or
# to run under any sanitizer, as what they test is dense linear algebra; they are part of ordinary builds only.
add_custom_target(patella_tests)

function(patella_add_test)
  cmake_parse_arguments(ARG "NEEDS_DATA;LONG" "NAME" "SOURCES;LIBRARIES;LABELS;SANITIZERS" ${ARGN})
  if(PATELLA_SANITIZER MATCHES "^(thread|realtime)$" AND NOT PATELLA_SANITIZER IN_LIST ARG_SANITIZERS)
    return()
  endif()
  if(PATELLA_SANITIZER AND ARG_LONG)
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
  set(timeout_s 300)
  if(PATELLA_SANITIZER OR ARG_LONG)
    set(timeout_s 1200)
  endif()
  set_tests_properties(${ARG_NAME} PROPERTIES SKIP_RETURN_CODE 77 LABELS "${ARG_LABELS}" TIMEOUT ${timeout_s})
  if(ARG_LONG)
    # Begins before the others, or the end waits for it with all processors but one.
    set_tests_properties(${ARG_NAME} PROPERTIES COST 100)
  endif()
endfunction()
