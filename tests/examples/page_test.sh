#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# docs/library.md against the files that it shows: page_test.sh SOURCE
set -euo pipefail
cd "$1"
page=docs/library.md
bad=0

wrong() {
  echo "$page: $1"
  bad=1
}

# The program of the page, between the first fence for C++ and the next one.
shown=$(awk '/^```cpp$/ { inside = 1; next } /^```$/ { if (inside) exit } inside' "$page")
diff <(echo "$shown") examples/own_vehicle.cpp ||
  wrong "the program differs from examples/own_vehicle.cpp as above; copy the file"

# The second program is part of an example: each line is one of it.
awk '/^```cpp$/ { inside = ++n == 2; next } /^```$/ { inside = 0 } inside' "$page" |
  grep -Fxvf examples/pendulum_filter.cpp &&
  wrong "the lines above are not in examples/pendulum_filter.cpp"

for program in examples/*.cpp; do
  name=$(basename "$program")
  [ "$(wc -l <"$program")" -le 60 ] || wrong "$name has more than 60 lines"
  for table in "$page" examples/README.md; do
    grep -q "^| \[\`$name\`\]" "$table" || wrong "the table of $table has no line for $name"
  done
  grep -q "Exit status: " "$program" || wrong "$name does not document its exit status"
  for list in examples/CMakeLists.txt tests/examples/CMakeLists.txt tests/install/check_install.sh; do
    grep -qw "${name%.cpp}" "$list" || wrong "$name is missing in $list"
  done
done

# Each umbrella header has a line: those that quadtune.hpp includes, and itself.
for header in quadtune/quadtune.hpp \
  $(sed -n 's/^#include "\(.*\)".*/\1/p' workbench/include/quadtune/quadtune.hpp); do
  grep -q "^| \`$header\` |" "$page" || wrong "the table of headers has no line for $header"
done
exit $bad
