# SPDX-License-Identifier: Apache-2.0
# Several source files of one folder are compiled as one, because most of the time goes into headers
# that they share. docs/decisions/0005-short-build.md has the figures.
#
# CMake's own UNITY_BUILD writes absolute paths (until 3.29), so ccache could not reuse the results in
# another checkout.
option(QUADTUNE_BATCHES "Compile the source files of a folder together" ON)
set(QUADTUNE_BATCH_SIZE 8)

# quadtune_batches(result target a.cpp b/c.cpp …) sets `result` to the files that the target compiles
# in place of these: generated files that include up to QUADTUNE_BATCH_SIZE of them each. Files that
# quadtune_separate() or quadtune_own_options() names, and files with absolute paths, are kept. Call
# those functions before this one.
function(quadtune_batches result target)
  if(NOT QUADTUNE_BATCHES)
    set(${result} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  set(compiled "")
  set(folders "")
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    get_source_file_property(separate ${source} QUADTUNE_SEPARATE)
    if(IS_ABSOLUTE ${source} OR separate)
      list(APPEND compiled ${source})
      continue()
    endif()
    string(MAKE_C_IDENTIFIER "in_${folder}" key)
    list(APPEND folders ${key})
    list(APPEND ${key} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(key IN LISTS folders)
    list(LENGTH ${key} count)
    math(EXPR last "(${count} - 1) / ${QUADTUNE_BATCH_SIZE}")
    foreach(number RANGE ${last})
      math(EXPR first "${number} * ${QUADTUNE_BATCH_SIZE}")
      list(SUBLIST ${key} ${first} ${QUADTUNE_BATCH_SIZE} batch)
      set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_batches/${key}_${number}.cpp)
      list(TRANSFORM batch REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE lines)
      string(JOIN "" text ${lines})
      file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
      list(APPEND compiled ${file})
    endforeach()
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  set(${result} ${compiled} PARENT_SCOPE)
endfunction()

# quadtune_separate(a.cpp …) makes the files be compiled by themselves.
function(quadtune_separate)
  set_source_files_properties(${ARGN} PROPERTIES QUADTUNE_SEPARATE ON)
endfunction()
