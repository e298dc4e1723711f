# SPDX-License-Identifier: Apache-2.0
# Registers the tests of a Google Test program with CTest, one entry for every suite: run as a script
# after the program is linked. One process for each test, as gtest_discover_tests() has it, spends
# more time on starting the program than on the tests: 20 minutes of a sanitized run.
#
#   cmake -D PROGRAM=… -D PREFIX=cli/ -D FILE=… -D "PROPERTIES=TIMEOUT;600;…" -P TestSuites.cmake
cmake_minimum_required(VERSION 3.25)

# A long suite is divided, so that its parts run at once and none of them runs for minutes.
set(most 12)

execute_process(COMMAND ${PROGRAM} --gtest_list_tests
                OUTPUT_VARIABLE listed RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests ended with ${status}: ${listed}")
endif()
# Values of parameters are comments here; they may hold what a CMake list cannot.
string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")
string(REGEX MATCHALL "[^\n]+" lines "${listed}")

set(properties "")
foreach(word IN LISTS PROPERTIES)
  string(APPEND properties " [==[${word}]==]")
endforeach()

set(script "")
# Adds the tests in `filter` as one entry.
macro(add_entry)
  if(filter)
    list(JOIN filter ":" joined)
    set(entry ${PREFIX}${suite})
    if(part GREATER 1 OR count GREATER_EQUAL most)
      string(APPEND entry "/part${part}")
    endif()
    string(APPEND script "add_test([==[${entry}]==] \"${PROGRAM}\" \"--gtest_filter=${joined}\")\n"
                         "set_tests_properties([==[${entry}]==] PROPERTIES${properties})\n")
    math(EXPR part "${part} + 1")
    set(filter "")
    set(count 0)
  endif()
endmacro()

set(filter "")
set(count 0)
set(part 1)
foreach(line IN LISTS lines)
  if(line MATCHES "^  (.+)$")
    list(APPEND filter "${suite}.${CMAKE_MATCH_1}")
    math(EXPR count "${count} + 1")
    if(count EQUAL most)
      add_entry()
    endif()
  elseif(line MATCHES "^([^ ]+)\\.$")
    add_entry()
    set(suite ${CMAKE_MATCH_1})
    set(part 1)
  endif()
endforeach()
add_entry()
file(WRITE ${FILE} "${script}")
