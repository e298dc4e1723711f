# SPDX-License-Identifier: Apache-2.0
# Debian packages by CPack: docs/packages.md. Each install component is a package; the component
# `licence` is not packed, as Debian has the text of the licence already.
if(NOT QUADTUNE_PACKAGE)
  return()
endif()
include(cmake/package/version.cmake)
set(QUADTUNE_MAINTAINER "The quadtune developers <quadtune@quadtune.invalid>" CACHE STRING
    "Who answers for the packages: name <address>")

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(QUADTUNE_LIBRARY_PACKAGE libquadtune${soversion})
set(program quadtune)
set(library ${QUADTUNE_LIBRARY_PACKAGE})
set(development libquadtune-dev)
set(documentation quadtune-doc)
set(python python3-quadtune)
set(components program library development documentation)
if(TARGET quadtune_python)
  list(APPEND components python)
endif()

# Files that Debian expects in every package.
set(folder ${PROJECT_BINARY_DIR}/package_files)
file(MAKE_DIRECTORY ${folder})
configure_file(cmake/package/changelog.in ${folder}/changelog.Debian @ONLY)
configure_file(CHANGELOG.md ${folder}/changelog COPYONLY)
execute_process(COMMAND gzip -9nfk changelog.Debian changelog
                WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS components)
  set(to ${CMAKE_INSTALL_DATADIR}/doc/${${component}})
  install(FILES cmake/package/copyright ${folder}/changelog.Debian.gz ${folder}/changelog.gz
          DESTINATION ${to} COMPONENT ${component})
endforeach()
configure_file(cmake/package/libquadtune.lintian-overrides ${folder}/${library} @ONLY)
install(FILES ${folder}/${library} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
        COMPONENT library)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME quadtune)
set(CPACK_PACKAGE_VERSION ${QUADTUNE_PACKAGE_VERSION})
set(CPACK_PACKAGE_CONTACT ${QUADTUNE_MAINTAINER})
# CPack's default, with which it leaves out the summary that would begin every description.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/package/repack.cmake)
set(CPACK_QUADTUNE_COMMIT_TIME ${QUADTUNE_COMMIT_TIME})

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE quadtune)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
# dpkg-shlibdeps computes the dependencies on Debian's libraries. It has to find quadtune's own
# libraries too, where they were built; the dependency on their package is CPACK_COMPONENT_*_DEPENDS.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
# Before 1.0 a minor version may change an interface, and an unreleased commit anything.
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")

foreach(component IN LISTS components)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${${component}})
endforeach()

set(about "quadtune computes the trim of a multirotor from its physical parameters,
linearizes the nonlinear model, solves the LQR, PID and Kalman problems,
samples them for the flight computer, writes the files that the flight code
reads, and reads them back to verify them.
")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SOURCE "")
set(CPACK_COMPONENT_PROGRAM_DEPENDS library)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "quadtune-doc, gcc, qemu-user, gcc-arm-linux-gnueabihf")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "computation of control gains for small multirotors
${about}
This package has the program, its man page and bash completion. The vehicles,
missions, designs, filters and campaigns that come with it are in
/usr/share/quadtune.
")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/package/triggers)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "control gains for small multirotors: shared libraries
${about}
This package has the shared libraries. The dynamic loader chooses kernels for
AVX2 or AVX-512 where the processor has these instructions.
")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS library)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "quadtune-doc, cmake, pkgconf")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "control gains for small multirotors: development files
${about}
This package has the headers of the C++20 libraries and what CMake and
pkg-config find them with.
")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION "control gains for small multirotors: documentation
${about}
This package has the manual of the commands, the theory with its sources, the
formats of files, and examples of programs that use the libraries.
")

# The module is compiled for one minor version of Python. postinst and prerm compile the module's
# Python files and remove what was compiled.
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON_DEPENDS library)
get_property(python_versions GLOBAL PROPERTY QUADTUNE_PYTHON_VERSIONS)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_versions}, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "quadtune-doc, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/cmake/package/python/postinst
    ${PROJECT_SOURCE_DIR}/cmake/package/python/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "control gains for small multirotors: Python 3 module
${about}
This package has the module for Python 3: the commands of the program as
functions, with NumPy arrays and type stubs.
")

include(CPack)
