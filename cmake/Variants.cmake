# SPDX-License-Identifier: Apache-2.0
# The kernels of each library for three kinds of x86-64 processors: any, those with AVX2 (x86-64-v3)
# and those with AVX-512 (x86-64-v4). docs/decisions/0011-variants.md says why in this way.
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
  # Those of another configuration of this build tree would still be loaded.
  file(REMOVE_RECURSE ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/glibc-hwcaps)
endif()
# Programs depend on the variant that the loader chooses on this machine; otherwise they would run with
# the variant of an earlier build. The other variants are built by `all`.
add_custom_target(quadtune_loaded_variant)
set(QUADTUNE_LOADED_VARIANT "")
if(QUADTUNE_VARIANT_NAMES)
  execute_process(COMMAND /lib64/ld-linux-x86-64.so.2 --help
                  OUTPUT_VARIABLE loader_help ERROR_QUIET RESULT_VARIABLE loader_status)
  if(NOT loader_status EQUAL 0)
    # Another C library, or one before glibc 2.33, which loads none of them.
    message(STATUS "the loader names no variants; the kernels for any processor will be loaded")
  endif()
  foreach(variant IN LISTS QUADTUNE_VARIANT_NAMES)
    if(loader_help MATCHES "${variant} \\(supported")
      set(QUADTUNE_LOADED_VARIANT ${variant})
    endif()
  endforeach()
endif()

# The objects of `target` that are compiled from `sources` (INCLUDE), or from others (EXCLUDE).
function(quadtune_objects result target which sources)
  string(REPLACE ";" "|" names "${sources}")
  string(REPLACE "." "[.]" names "${names}")
  set(${result} "$<FILTER:$<TARGET_OBJECTS:${target}>,${which},/(${names})[.]o$>" PARENT_SCOPE)
endfunction()

# quadtune_variants(target KERNELS a.cpp … AVX2_KERNELS b.cpp … PACKED_KERNELS c.cpp … LINK …)
# AVX2_KERNELS gain nothing by wider vectors than AVX2's: both variants share their objects.
# PACKED_KERNELS simulate several flights at once. Where variants are built, only the variants contain
# them; the library for any processor simulates one flight after the other, with the same results.
function(quadtune_variants target)
  cmake_parse_arguments(ARG "" "" "KERNELS;AVX2_KERNELS;PACKED_KERNELS;LINK" ${ARGN})
  set(all ${ARG_KERNELS} ${ARG_AVX2_KERNELS} ${ARG_PACKED_KERNELS})
  if(NOT all)
    return()
  endif()
  if(NOT QUADTUNE_VARIANT_NAMES)
    target_sources(${target} PRIVATE ${ARG_PACKED_KERNELS})
    return()
  endif()
  if(ARG_PACKED_KERNELS)
    target_compile_definitions(${target} PRIVATE QUADTUNE_ONE_AT_A_TIME)
  endif()
  quadtune_objects(rest ${target} EXCLUDE "${all}")
  foreach(variant IN LISTS QUADTUNE_VARIANT_NAMES)
    set(copy ${target}_${variant})
    set(sources ${all})
    if(variant STREQUAL x86-64-v4 AND ARG_AVX2_KERNELS)
      quadtune_objects(shared ${target}_x86-64-v3 INCLUDE "${ARG_AVX2_KERNELS}")
      set(sources ${ARG_KERNELS} ${ARG_PACKED_KERNELS} ${shared})
    endif()
    add_library(${copy} SHARED ${sources} ${rest} $<TARGET_OBJECTS:quadtune_eigen>)
    set(folder glibc-hwcaps/${variant})
    set_target_properties(
      ${copy} PROPERTIES OUTPUT_NAME ${target}
                         LINKER_LANGUAGE CXX
                         LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${folder}
                         VERSION ${PROJECT_VERSION}
                         SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                         INSTALL_RPATH $ORIGIN/../..)
    target_compile_options(${copy} PRIVATE -march=${variant})
    target_include_directories(${copy} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    target_link_libraries(${copy} PRIVATE ${ARG_LINK} $<BUILD_INTERFACE:quadtune_flags>)
    quadtune_keeps_to_itself(${copy})
    if(variant STREQUAL QUADTUNE_LOADED_VARIANT)
      add_dependencies(quadtune_loaded_variant ${copy})
    endif()
    install(TARGETS ${copy} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/${folder}
            COMPONENT library NAMELINK_SKIP)
  endforeach()
endfunction()
