# SPDX-License-Identifier: Apache-2.0
# What others find the installed libraries with: a CMake package and a pkg-config file.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/quadtune)
configure_package_config_file(cmake/quadtune-config.cmake.in quadtune-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0 every minor version may change an interface.
write_basic_package_version_file(quadtune-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/quadtune-config.cmake
              ${PROJECT_BINARY_DIR}/quadtune-config-version.cmake
        DESTINATION ${package_dir} COMPONENT development)
install(EXPORT quadtune-targets NAMESPACE quadtune:: DESTINATION ${package_dir}
        COMPONENT development)

get_property(libraries GLOBAL PROPERTY QUADTUNE_LIBRARIES)
list(TRANSFORM libraries PREPEND "-l" OUTPUT_VARIABLE QUADTUNE_PC_LIBS)
list(JOIN QUADTUNE_PC_LIBS " " QUADTUNE_PC_LIBS)
list(TRANSFORM QUADTUNE_EIGEN_ALIGNMENT PREPEND "-D" OUTPUT_VARIABLE QUADTUNE_PC_DEFINITIONS)
list(JOIN QUADTUNE_PC_DEFINITIONS " " QUADTUNE_PC_DEFINITIONS)
file(RELATIVE_PATH QUADTUNE_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" QUADTUNE_PC_PREFIX "${QUADTUNE_PC_PREFIX}")
configure_file(cmake/quadtune.pc.in quadtune.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/quadtune.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT development)

install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)
