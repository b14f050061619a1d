# The libraries for programs of others, as the component "development":
#
#   cmake --install build/release --prefix PREFIX --component development
#
# find_package(patella COMPONENTS core drivers sim) then has patella::core, patella::drivers and patella::sim. Each has an
# export of its own, so that who wants core alone needs Eigen alone.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/patella")

# One line "library targets...".
foreach(line IN ITEMS "core patella_settings patella_core" "drivers patella_drivers" "sim patella_sim")
  string(REPLACE " " ";" targets "${line}")
  list(POP_FRONT targets library)
  foreach(target IN LISTS targets)
    string(REPLACE "patella_" "" name "${target}")
    set_property(TARGET ${target} PROPERTY EXPORT_NAME ${name})
    add_library(patella::${name} ALIAS ${target})
  endforeach()
  install(TARGETS ${targets} EXPORT patella-${library}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
  install(EXPORT patella-${library} NAMESPACE patella:: FILE patella-${library}.cmake
    DESTINATION "${package_folder}" COMPONENT development)
  # The kernels' headers are compiled once for each instruction set, and hold nothing for others.
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${library}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/patella"
    COMPONENT development FILES_MATCHING PATTERN "*.hpp" PATTERN "kernel_*.hpp" EXCLUDE)
endforeach()

# What the rig's messages look like, for examples and for rigs of one's own.
install(FILES "${PROJECT_SOURCE_DIR}/drivers/can/patella.dbc" DESTINATION "${CMAKE_INSTALL_DATADIR}/patella"
  COMPONENT development)

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/patellaConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/patellaConfig.cmake" INSTALL_DESTINATION "${package_folder}"
  PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/patellaConfigVersion.cmake" COMPATIBILITY SameMajorVersion)
install(FILES "${PROJECT_BINARY_DIR}/patellaConfig.cmake" "${PROJECT_BINARY_DIR}/patellaConfigVersion.cmake"
  DESTINATION "${package_folder}" COMPONENT development)
