# One library per folder: its own include root, its own private dependencies.

add_library(quadtune_flags INTERFACE)
target_compile_features(quadtune_flags INTERFACE cxx_std_20)
target_compile_options(quadtune_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow
                                                -ffp-contract=off)
# GCC 12 reports its own AVX-512 intrinsics as uninitialized wherever Eigen uses them.
target_compile_options(quadtune_flags INTERFACE -Wno-maybe-uninitialized)
if(QUADTUNE_NATIVE)
  target_compile_options(quadtune_flags INTERFACE -march=native)
endif()
if(QUADTUNE_WERROR)
  target_compile_options(quadtune_flags INTERFACE -Werror)
endif()
if(QUADTUNE_SANITIZE)
  target_compile_options(quadtune_flags INTERFACE -fsanitize=${QUADTUNE_SANITIZE}
                                                  -fno-omit-frame-pointer)
  target_link_options(quadtune_flags INTERFACE -fsanitize=${QUADTUNE_SANITIZE})
endif()

# quadtune_library(synthesis SOURCES … PUBLIC … PRIVATE …) makes quadtune::synthesis from
# synthesis/include and the sources. Headers of libraries given as PRIVATE stay out of its interface.
function(quadtune_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target quadtune_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(quadtune::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
              PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC}
                                  PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:quadtune_flags>)
  install(TARGETS ${target} EXPORT quadtune-targets)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# quadtune_test(synthesis SOURCES … LINK … LABELS …) makes one test program and registers its tests.
function(quadtune_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LABELS" ${ARGN})
  set(target test_${name})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} quadtune_test_support quadtune_flags)
  gtest_discover_tests(${target} TEST_PREFIX "${name}/" DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 600)
endfunction()
