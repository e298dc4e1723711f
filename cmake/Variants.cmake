# SPDX-License-Identifier: Apache-2.0
# The kernels of each library for three kinds of x86-64 processors: any, those with AVX2 (x86-64-v3)
# and those with AVX-512 (x86-64-v4). docs/decisions/0006-variants.md says why in this way.
#
# A variant is the whole shared library once more: the kernels compiled for it, everything else the
# objects of the library itself. It lies in lib/glibc-hwcaps/x86-64-v3 or -v4, where the dynamic
# loader looks first on a machine that has these instructions, so that no code chooses anything.
if(QUADTUNE_VARIANTS AND CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT QUADTUNE_NATIVE
   AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND CMAKE_BUILD_TYPE MATCHES "^Rel"
   AND NOT QUADTUNE_SANITIZE)
  set(QUADTUNE_VARIANT_NAMES x86-64-v3 x86-64-v4)
else()
  set(QUADTUNE_VARIANT_NAMES "")
endif()

# quadtune_variants(target KERNELS a.cpp … PRIVATE libraries …)
function(quadtune_variants target)
  cmake_parse_arguments(ARG "" "" "KERNELS;LINK" ${ARGN})
  if(NOT ARG_KERNELS)
    return()
  endif()
  # The objects of the library, without those of its kernels.
  string(REPLACE ";" "|" kernels "${ARG_KERNELS}")
  string(REPLACE "." "[.]" kernels "${kernels}")
  set(rest "$<FILTER:$<TARGET_OBJECTS:${target}>,EXCLUDE,/(${kernels})[.]o$>")
  foreach(variant IN LISTS QUADTUNE_VARIANT_NAMES)
    set(copy ${target}_${variant})
    add_library(${copy} SHARED ${ARG_KERNELS} ${rest} $<TARGET_OBJECTS:quadtune_eigen>)
    set(folder glibc-hwcaps/${variant})
    set_target_properties(
      ${copy} PROPERTIES OUTPUT_NAME ${target}
                         LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${folder}
                         VERSION ${PROJECT_VERSION}
                         SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                         INSTALL_RPATH $ORIGIN/../..)
    target_compile_options(${copy} PRIVATE -march=${variant})
    target_include_directories(${copy} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}
                                               ${CMAKE_CURRENT_SOURCE_DIR}/include)
    target_link_libraries(${copy} PRIVATE ${ARG_LINK} $<BUILD_INTERFACE:quadtune_flags>)
    quadtune_keeps_to_itself(${copy})
    # Whoever builds the library gets its variants.
    add_dependencies(quadtune_variants ${copy})
    install(TARGETS ${copy} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/${folder} NAMELINK_SKIP)
  endforeach()
endfunction()
add_custom_target(quadtune_variants)
