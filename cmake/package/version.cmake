# SPDX-License-Identifier: Apache-2.0
# The version of the Debian packages, from the commit that they are made of. Sets QUADTUNE_COMMIT,
# QUADTUNE_COMMIT_TIME (seconds since 1970), QUADTUNE_COMMIT_DATE (RFC 5322) and
# QUADTUNE_PACKAGE_VERSION. Run as a script, it prints the last of these and the time:
#
#   cmake -P cmake/package/version.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(source ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)

# `git archive` writes the commit into this file; in a checkout, git knows it.
file(READ ${CMAKE_CURRENT_LIST_DIR}/commit.txt commit)
if(NOT commit MATCHES "^([0-9a-f]+) ([0-9]+)")
  execute_process(COMMAND git -C ${source} log -1 --format=%H\ %ct
                  OUTPUT_VARIABLE commit COMMAND_ERROR_IS_FATAL ANY)
  if(NOT commit MATCHES "^([0-9a-f]+) ([0-9]+)")
    message(FATAL_ERROR "${source}: git names no commit; expected a clone or an archive made by git")
  endif()
endif()
set(QUADTUNE_COMMIT ${CMAKE_MATCH_1})
set(QUADTUNE_COMMIT_TIME ${CMAKE_MATCH_2})

# string(TIMESTAMP) formats this time instead of the present.
set(epoch "$ENV{SOURCE_DATE_EPOCH}")
set(ENV{SOURCE_DATE_EPOCH} ${QUADTUNE_COMMIT_TIME})
string(TIMESTAMP QUADTUNE_COMMIT_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
string(TIMESTAMP day "%Y%m%d" UTC)
if(epoch STREQUAL "")
  unset(ENV{SOURCE_DATE_EPOCH})
else()
  set(ENV{SOURCE_DATE_EPOCH} "${epoch}")
endif()

# A version that the changelog describes is released. Before that, the version sorts before it.
file(STRINGS ${source}/lib/include/quadtune/version.hpp line REGEX "kVersion")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" QUADTUNE_PACKAGE_VERSION "${line}")
string(REPLACE "." "\\." pattern "${QUADTUNE_PACKAGE_VERSION}")
file(STRINGS ${source}/CHANGELOG.md released REGEX "^## \\[?${pattern}([] ]|$)")
if(NOT released)
  string(SUBSTRING ${QUADTUNE_COMMIT} 0 8 short)
  string(APPEND QUADTUNE_PACKAGE_VERSION "~git${day}.${short}")
endif()

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E echo "${QUADTUNE_PACKAGE_VERSION} ${QUADTUNE_COMMIT_TIME}")
endif()
