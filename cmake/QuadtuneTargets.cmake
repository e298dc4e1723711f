# SPDX-License-Identifier: Apache-2.0
# One shared library per folder: its own include root, its own private dependencies.
# docs/decisions/0003-shared-libraries.md says why shared, and why the alignment is fixed.

# Eigen aligns to the widest vector of the machine it is compiled for, so a program built without
# -march=native would lay out and free matrices otherwise than these libraries. One value for all;
# both macros, since the first alone leaves the layout of fixed-size matrices to the machine.
set(QUADTUNE_EIGEN_ALIGNMENT EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=64)

add_library(quadtune_flags INTERFACE)
target_compile_features(quadtune_flags INTERFACE cxx_std_20)
target_compile_definitions(quadtune_flags INTERFACE ${QUADTUNE_EIGEN_ALIGNMENT})
# Without semantic interposition the compiler may inline within a shared library as in a program.
target_compile_options(quadtune_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow
                                                -ffp-contract=off -fno-semantic-interposition)
# GCC collects the garbage of its own heap less often: this takes off up to a tenth of its time and
# adds up to a fifth to its memory.
target_compile_options(quadtune_flags INTERFACE
                       $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
# GCC 12 reports its own AVX-512 intrinsics wherever Eigen uses them, and copies within std::string
# (GCC bug 105651); from a precompiled header it does so under more names.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(quadtune_flags INTERFACE -Wno-maybe-uninitialized -Wno-uninitialized
                                                  -Wno-array-bounds -Wno-restrict
                                                  -Wno-stringop-overflow -Wno-stringop-overread)
endif()
# In a build for machines without wide vectors, the kernels' are passed in another way; they never
# leave their source file.
target_compile_options(quadtune_flags INTERFACE -Wno-psabi)
if(QUADTUNE_NATIVE)
  target_compile_options(quadtune_flags INTERFACE -march=native)
endif()
# For sources that simulate flights, alone and in packs. GCC 12's own vectors would make fused
# multiply-adds of neighbouring sums and differences (vfmaddsub) whatever -ffp-contract says, so that
# the two would not give the same bytes; and they slow a step down by half, being stored in parts and
# loaded whole.
set(QUADTUNE_PACKS_ONLY $<$<CXX_COMPILER_ID:GNU>:-fno-tree-vectorize>)
if(QUADTUNE_WERROR)
  target_compile_options(quadtune_flags INTERFACE -Werror)
endif()
# A program that reads files of others keeps what a wrong write could do small: canaries on the stack,
# checked sizes in the C library, nothing writable that the loader jumps through, addresses that
# nobody knows. Sanitizers check sizes themselves, and without optimization the headers cannot.
if(QUADTUNE_HARDEN)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  target_compile_options(quadtune_flags INTERFACE -fstack-protector-strong)
  target_link_options(quadtune_flags INTERFACE -Wl,-z,relro,-z,now)
  if(NOT QUADTUNE_SANITIZE AND NOT QUADTUNE_BUILD_FUZZERS)
    target_compile_options(quadtune_flags INTERFACE
      $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2>)
  endif()
endif()
if(QUADTUNE_SANITIZE)
  target_compile_options(quadtune_flags INTERFACE -fsanitize=${QUADTUNE_SANITIZE}
                                                  -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer)
  target_link_options(quadtune_flags INTERFACE -fsanitize=${QUADTUNE_SANITIZE})
  if(QUADTUNE_SANITIZE MATCHES undefined)
    # Up to half of the compile time for what others see as well: ASan stops at a null pointer and at
    # what lies beyond an object, and Eigen asserts the alignment of its matrices. The weekly run has
    # the checks of null and alignment on all the same.
    if(QUADTUNE_SANITIZE_POINTERS)
      target_compile_options(quadtune_flags INTERFACE -fno-sanitize=pointer-overflow)
    else()
      target_compile_options(quadtune_flags INTERFACE -fno-sanitize=null,alignment,pointer-overflow)
    endif()
  endif()
endif()

# quadtune::quadtune is every library at once; quadtune_library() adds to it.
add_library(quadtune_all INTERFACE)
add_library(quadtune::quadtune ALIAS quadtune_all)
set_target_properties(quadtune_all PROPERTIES EXPORT_NAME quadtune)
install(TARGETS quadtune_all EXPORT quadtune-targets COMPONENT development)

# A library keeps to its own copies of Eigen's templates, not to the slower ones of a program that
# was compiled for any machine; and whatever it calls must be in a library it may know.
function(quadtune_keeps_to_itself target)
  target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions)
  if(NOT QUADTUNE_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
endfunction()

# A regular expression of the headers that are not installed (scripts/implementation_headers.txt).
function(quadtune_internal_headers result)
  set(list ${PROJECT_SOURCE_DIR}/scripts/implementation_headers.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${list})
  file(STRINGS ${list} lines REGEX "^quadtune/")
  list(TRANSFORM lines REPLACE " .*$" "")
  list(TRANSFORM lines REPLACE "[.]" "[.]")
  list(JOIN lines "|" names)
  set(${result} ${names} PARENT_SCOPE)
endfunction()

# quadtune_library(synthesis SOURCES … KERNELS … PUBLIC … PRIVATE …) makes quadtune::synthesis from
# synthesis/include and the sources. Headers of libraries given as PRIVATE stay out of its interface.
# KERNELS, AVX2_KERNELS and PACKED_KERNELS are sources whose speed depends on the processor's vector
# instructions (Variants.cmake). LIGHT libraries leave expensive computations to the others: -O1
# reduces their compile time to two thirds. The first of them makes the precompiled header of all.
function(quadtune_library name)
  cmake_parse_arguments(ARG "LIGHT" "" "SOURCES;KERNELS;AVX2_KERNELS;PACKED_KERNELS;PUBLIC;PRIVATE" ${ARGN})
  set(target quadtune_${name})
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS include/*.hpp)
  add_library(${target} SHARED ${ARG_KERNELS} ${ARG_AVX2_KERNELS})
  quadtune_batches(sources ${target} ${ARG_SOURCES})
  target_sources(${target} PRIVATE ${sources})
  add_library(quadtune::${name} ALIAS ${target})
  set_target_properties(
    ${target} PROPERTIES EXPORT_NAME ${name}
                         VERSION ${PROJECT_VERSION}
                         SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  quadtune_internal_headers(internal)
  set(for_users ${headers})
  list(FILTER for_users EXCLUDE REGEX "/(${internal})$")
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${for_users})
  list(REMOVE_ITEM headers ${for_users})
  if(headers)
    target_sources(${target} PRIVATE FILE_SET implementation TYPE HEADERS BASE_DIRS include FILES ${headers})
  endif()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_definitions(${target} PUBLIC ${QUADTUNE_EIGEN_ALIGNMENT})
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC}
                                  PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:quadtune_flags>)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:quadtune_eigen>)
  set(header_of quadtune_eigen)
  if(ARG_LIGHT)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    # GCC does not use a header that was precompiled with another macro, as x_EXPORTS.
    set_target_properties(${target} PROPERTIES DEFINE_SYMBOL "")
    get_property(header_of GLOBAL PROPERTY QUADTUNE_LIGHT_HEADER_OF)
  endif()
  if(header_of)
    target_precompile_headers(${target} REUSE_FROM ${header_of})
  else()
    target_precompile_headers(${target} PRIVATE <quadtune/internal/precompiled.hpp>)
    set_property(GLOBAL PROPERTY QUADTUNE_LIGHT_HEADER_OF ${target})
  endif()
  quadtune_keeps_to_itself(${target})
  quadtune_variants(${target} KERNELS ${ARG_KERNELS} AVX2_KERNELS ${ARG_AVX2_KERNELS}
                    PACKED_KERNELS ${ARG_PACKED_KERNELS} LINK ${ARG_PUBLIC} ${ARG_PRIVATE})
  install(TARGETS ${target} EXPORT quadtune-targets
          LIBRARY COMPONENT library NAMELINK_COMPONENT development
          FILE_SET HEADERS COMPONENT development)
  target_link_libraries(quadtune_all INTERFACE ${target})
  set_property(GLOBAL APPEND PROPERTY QUADTUNE_LIBRARIES ${target})
endfunction()

# quadtune_test(synthesis SOURCES … LINK … LABELS …) makes one test program and registers its tests.
function(quadtune_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LABELS" ${ARGN})
  set(target test_${name})
  add_executable(${target})
  set(QUADTUNE_BATCH_SIZE 4) # a changed test is compiled again within half a minute
  quadtune_batches(sources ${target} ${ARG_SOURCES})
  target_sources(${target} PRIVATE ${sources})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} quadtune_test_support quadtune_test_flags)
  target_precompile_headers(${target} REUSE_FROM quadtune_test_support)
  add_dependencies(${target} quadtune_loaded_variant)
  # Threads of OpenBLAS would fight for the processors with the tests that run beside.
  set(properties TIMEOUT 1800 ENVIRONMENT OPENBLAS_NUM_THREADS=1)
  if(ARG_LABELS)
    list(APPEND properties LABELS "${ARG_LABELS}")
  endif()
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  if(NOT EXISTS ${suites})
    file(WRITE ${suites} "add_test(${target}_is_not_built ${target})\n")
  endif()
  add_custom_command(
    TARGET ${target} POST_BUILD BYPRODUCTS ${suites}
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:${target}> -D PREFIX=${name}/
            -D FILE=${suites} -D "PROPERTIES=${properties}"
            -P ${PROJECT_SOURCE_DIR}/cmake/TestSuites.cmake
    VERBATIM)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
endfunction()
