#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Properties of the linked program and its libraries in BUILD: addresses that are randomized at each
# start, no writable table of functions, no executable stack, canaries. FORTIFIED is 1 if sizes are
# checked in the C library.
set -euo pipefail
status=0

# expect FILE WHAT PATTERN: a line of the standard input fits.
expect() {
  grep -Eq "$3" || { echo "$1: $2" && status=1; }
}

for file in "$BUILD"/bin/quadtune "$BUILD"/lib/libquadtune_*.so; do
  name=$(basename "$file")
  header=$(readelf -hW "$file")
  segments=$(readelf -lW "$file")
  dynamic=$(readelf -dW "$file")
  symbols=$(readelf --dyn-syms -W "$file")
  expect "$name" "is not position-independent" 'Type: +DYN' <<<"$header"
  expect "$name" "has no GNU_RELRO segment" 'GNU_RELRO' <<<"$segments"
  expect "$name" "binds functions late: its RELRO is partial" 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic"
  expect "$name" "has a stack that can be executed" 'GNU_STACK .* RW +0x' <<<"$segments"
  # The program itself has no array on its stack.
  [ "$name" = quadtune ] || expect "$name" "has no canaries" '__stack_chk_fail' <<<"$symbols"
done
expect quadtune "is no PIE" 'FLAGS_1.*PIE' <<<"$(readelf -dW "$BUILD/bin/quadtune")"
# If all sizes are known to be valid, a library does not show it; the compile commands do.
if [ "$FORTIFIED" = 1 ]; then
  sources='"command": .* -c [^ ]*/(lib|linearize|discretize|synthesis|tuning|exports|workbench|cli)/[^ ]*\.cpp'
  compiled=$(grep -Ec "$sources" "$BUILD/compile_commands.json")
  checked=$(grep -E "$sources" "$BUILD/compile_commands.json" | grep -Fc -- '-D_FORTIFY_SOURCE=2' || true)
  if [ "$compiled" = 0 ] || [ "$checked" != "$compiled" ]; then
    echo "$checked of $compiled sources are compiled with checked calls of the C library"
    status=1
  fi
fi
exit $status
