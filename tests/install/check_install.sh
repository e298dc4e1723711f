#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One step of the test of the installation: check_install.sh install|find_package|pkg_config
# BUILD is the build tree, WORK a folder of this test's own, VERSION what is expected.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
# Moved after the installation: the installed tree must not depend on its location.
prefix=$WORK/moved

# The output of `program` must be the project's version, then "ok" (see outside/main.cpp).
expect_output() {
  local output
  output=$("$1") || true
  echo "$output"
  [ "$output" = "quadtune $VERSION ok" ] || { echo "expected: quadtune $VERSION ok" && exit 1; }
}

case $1 in
  install)
    rm -rf "$WORK"
    "$CMAKE" --install "$BUILD" --prefix "$WORK/prefix" >/dev/null
    mv "$WORK/prefix" "$prefix"
    ;;
  find_package)
    "$CMAKE" -S "$here/outside" -B "$WORK/outside" -G Ninja -DCMAKE_PREFIX_PATH="$prefix"
    "$CMAKE" --build "$WORK/outside"
    expect_output "$WORK/outside/outside"
    for example in own_vehicle lqg_margins schedule noise_from_log campaign own_estimator own_law own_exporter \
      pendulum_filter; do
      "$here/../examples/example_test.sh" "$WORK/outside" "$here/../.." "$example"
    done
    ;;
  pkg_config)
    pc=$(find "$prefix" -name quadtune.pc)
    PKG_CONFIG_PATH=$(dirname "$pc")
    export PKG_CONFIG_PATH
    libdir=$(pkg-config --variable=libdir quadtune)
    # shellcheck disable=SC2046,SC2086 # flags are words
    "$CXX" -std=c++20 ${CXXFLAGS:-} "$here/outside/main.cpp" -o "$WORK/outside_pkg_config" \
      $(pkg-config --cflags --libs quadtune) -Wl,-rpath,"$libdir"
    expect_output "$WORK/outside_pkg_config"
    ;;
  *) echo "check_install.sh: no step '$1'" >&2 && exit 2 ;;
esac
