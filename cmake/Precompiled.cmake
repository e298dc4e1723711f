# SPDX-License-Identifier: Apache-2.0
# Headers that most source files include, and the instantiations of Eigen's decompositions, are
# compiled once: docs/decisions/0005-short-build.md.
#
# GCC uses a precompiled header only where its options are those of the source file, so there is one
# for each kind of target: libraries (quadtune_eigen), results and program (quadtune_report) and
# tests (quadtune_test_support). A source file with options of its own is compiled without it.
add_library(quadtune_eigen OBJECT
  lib/compiled_eigen/eigenvalues.cpp
  lib/compiled_eigen/factorizations.cpp
  lib/compiled_eigen/products.cpp
  lib/compiled_eigen/singular_values.cpp)
target_include_directories(quadtune_eigen PRIVATE lib/internal)
target_link_libraries(quadtune_eigen PRIVATE quadtune_flags Eigen3::Eigen fmt::fmt)
# In angle brackets, so that what CMake writes does not hold the name of the checkout: ccache would
# compile everything again in the next one.
target_precompile_headers(quadtune_eigen PRIVATE <quadtune/internal/precompiled.hpp>)

# quadtune_own_options(file.cpp … OPTIONS …) compiles some source files with options of their own.
function(quadtune_own_options)
  cmake_parse_arguments(ARG "" "" "OPTIONS" ${ARGN})
  set_source_files_properties(${ARG_UNPARSED_ARGUMENTS} PROPERTIES
    COMPILE_OPTIONS "${ARG_OPTIONS}" SKIP_PRECOMPILE_HEADERS ON QUADTUNE_SEPARATE ON)
endfunction()
