# SPDX-License-Identifier: Apache-2.0
# Source files of one folder are compiled several at once: most of a file's compile time goes into
# the headers that it shares with its neighbours. docs/decisions/0005-short-build.md has the figures.
#
# CMake's own UNITY_BUILD names the files by absolute paths (until 3.29), so that ccache would not
# find them from another checkout.
option(QUADTUNE_BATCHES "Compile the source files of a folder together" ON)
set(QUADTUNE_BATCH_SIZE 8)

# quadtune_batches(result target a.cpp b/c.cpp …) sets `result` to the files to compile in their
# place. Files with options of their own and files that are not in the source tree stay as they are.
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

# quadtune_separate(a.cpp …): these are compiled by themselves.
function(quadtune_separate)
  set_source_files_properties(${ARGN} PROPERTIES QUADTUNE_SEPARATE ON)
endfunction()
