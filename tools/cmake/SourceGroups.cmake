# With PATELLA_GROUP_SOURCES the sources of programs and of their libraries are compiled eight at a time, which takes half as long.
# Sources of core, drivers and sim are small, and those of tests use the same names in one file and the next: each stays alone.
#
# CMAKE_UNITY_BUILD does the same with absolute paths in what it compiles, so that no two checkouts would share an object in a
# compiler's cache.
include(Targets)

option(PATELLA_GROUP_SOURCES "compile the sources of programs eight at a time" OFF)

function(patella_group_sources target)
  get_target_property(type ${target} TYPE)
  patella_links(${target} patella_settings finds_headers)
  if(NOT type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$" OR NOT finds_headers)
    return()
  endif()
  get_target_property(folder ${target} SOURCE_DIR)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(TRANSFORM sources PREPEND "${folder}/" REGEX "^[^/]")
  list(LENGTH sources count)
  if(count LESS 2)
    return()
  endif()
  set_source_files_properties(${sources} TARGET_DIRECTORY ${target} PROPERTIES HEADER_FILE_ONLY ON)
  set(number 0)
  while(sources)
    list(SUBLIST sources 0 8 group)
    list(REMOVE_ITEM sources ${group})
    list(TRANSFORM group REPLACE "^${PROJECT_SOURCE_DIR}/(.*)$" "#include \"\\1\"\n")
    string(JOIN "" content ${group})
    set(file "${PROJECT_BINARY_DIR}/groups/${target}_${number}.cpp")
    file(CONFIGURE OUTPUT "${file}" CONTENT "${content}" @ONLY)
    target_sources(${target} PRIVATE "${file}")
    math(EXPR number "${number} + 1")
  endwhile()
endfunction()

if(PATELLA_GROUP_SOURCES)
  patella_targets_in(targets "${PROJECT_SOURCE_DIR}/firmware_app")
  patella_targets_in(of_tools "${PROJECT_SOURCE_DIR}/tools")
  foreach(target IN LISTS targets of_tools)
    patella_group_sources(${target})
  endforeach()
endif()
