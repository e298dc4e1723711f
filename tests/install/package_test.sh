#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# package_test.sh FILE.deb ...: installs the packages in a minimal Debian 12 of its own, runs what users
# run, removes the packages, and compares all files with those that were there before.
#
# Needs root, and a network for the packages that these depend on. QUADTUNE_PACKAGE_ROOT names the
# folder of a minimal Debian 12 that has /etc/apt/sources.list; it is copied and stays as it is.
# Without it, debootstrap makes one.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")

# All mounts are in a namespace of this script, and go with it.
if [ "${QUADTUNE_PACKAGE_WORK:-}" = "" ]; then
  [ "$(id -u)" = 0 ] || { echo "package_test.sh: needs root, for chroot" >&2 && exit 2; }
  [ $# -gt 0 ] || { echo "package_test.sh: no packages given; expected files *.deb" >&2 && exit 2; }
  QUADTUNE_PACKAGE_WORK=$(mktemp -d /var/tmp/quadtune-packages.XXXXXX)
  export QUADTUNE_PACKAGE_WORK
  status=0
  unshare --mount --propagation private "$0" "$@" || status=$?
  rm -rf --one-file-system "$QUADTUNE_PACKAGE_WORK"
  [ $status != 0 ] || echo "package_test.sh: passed"
  exit $status
fi
work=$QUADTUNE_PACKAGE_WORK
root=$work/root

say() { printf 'package_test.sh: %s\n' "$*"; }
fail() {
  printf 'package_test.sh: %s\n' "$*" >&2
  exit 1
}

# inside COMMAND ...: in the minimal system, with nothing of this one's environment.
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive "$@" </dev/null
}

# quietly COMMAND ...: shows the output only if the command fails.
quietly() {
  "$@" >"$work/output" 2>&1 || {
    tail -n 40 "$work/output"
    fail "failed: $*"
  }
}

# Everything but what apt and dpkg keep for themselves, temporary files and the work of this test.
files_inside() {
  inside find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /root \
    -o -path /var/log -o -path /var/cache -o -path /var/lib/apt -o -path '/var/lib/dpkg/*-old' \
    -o -path /var/lib/dpkg/status -o -path /var/lib/dpkg/lock -o -path /var/lib/dpkg/triggers \) \
    -prune -o \( -type d -printf 'd %m %u:%g %p\n' \) -o -printf '%y %m %u:%g %s %p %l\n' | LC_ALL=C sort
}

if [ -n "${QUADTUNE_PACKAGE_ROOT:-}" ]; then
  say "copying $QUADTUNE_PACKAGE_ROOT"
  cp -a "$QUADTUNE_PACKAGE_ROOT" "$root"
else
  say "debootstrap"
  quietly debootstrap --variant=minbase --include=ca-certificates bookworm "$root"
fi
mount -t proc proc "$root/proc"
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d" # no service is started
chmod +x "$root/usr/sbin/policy-rc.d"

mkdir "$root/root/packages" "$root/root/work"
names=()
for package in "$@"; do
  cp "$package" "$root/root/packages"
  names+=("$(dpkg-deb -f "$package" Package)")
done
has() { [[ " ${names[*]} " == *" $1 "* ]]; }

say "installing what the packages depend on, a compiler and CMake"
quietly inside apt-get update -q
tools=(g++ make cmake pkgconf)
! has python3-quadtune || tools+=(python3-pytest)
quietly inside apt-get install -y -q --no-install-recommends "${tools[@]}"
mapfile -t needed < <(inside sh -c 'apt-get -s install --no-install-recommends /root/packages/*.deb' |
  awk '/^Inst / { print $2 }' | grep -vxF -f <(printf '%s\n' "${names[@]}"))
[ ${#needed[@]} = 0 ] || quietly inside apt-get install -y -q --no-install-recommends "${needed[@]}"
files_inside >"$work/before"

say "installing ${names[*]}"
quietly inside sh -c 'dpkg -i /root/packages/*.deb'
quietly inside apt-get check
files_inside >"$work/installed"

say "the files of the packages"
for file in /usr/bin/quadtune /usr/share/man/man1/quadtune.1.gz \
  /usr/share/bash-completion/completions/quadtune /usr/share/quadtune/vehicles/quad-450.toml \
  /usr/share/quadtune/missions/hover.toml /usr/share/quadtune/designs/uquad-hover.toml \
  /usr/share/quadtune/filters/uquad.toml /usr/share/quadtune/campaigns/mambo-hover.toml \
  /usr/share/doc/quadtune/docs/cli.md /usr/share/doc/quadtune/examples/own_vehicle.cpp; do
  [ -f "$root$file" ] || fail "$file is missing"
done
for name in "${names[@]}"; do
  for file in copyright changelog.gz changelog.Debian.gz; do
    [ -f "$root/usr/share/doc/$name/$file" ] || fail "/usr/share/doc/$name/$file is missing"
  done
done
quietly inside sh -c 'zcat /usr/share/man/man1/quadtune.1.gz | grep -q "^.SS design"'
quietly inside bash -c '. /usr/share/bash-completion/completions/quadtune && complete -p quadtune'

say "the designs of ./dev demo"
for design in uquad-hover mambo-hover uquad-flight rolling-spider-flight crazyflie-flight; do
  quietly inside sh -c "cd /root/work && quadtune design /usr/share/quadtune/designs/$design.toml -o out/$design"
  grep -q '^verdict  *pass$' "$work/output" || fail "the design $design has no verdict 'pass'"
  [ -s "$root/root/work/out/$design/manifest.json" ] || fail "the design $design has written no manifest"
done
quietly inside sh -c 'cd /root/work && quadtune export out/crazyflie-flight --to c -o out/crazyflie-c &&
  quadtune fly crazyflie --gains out/crazyflie-c --compiled'
vehicle=/usr/share/quadtune/vehicles/quad-450.toml
quietly inside sh -c "cd /root/work &&
  quadtune pid $vehicle --structure p-pi -o out/quad-450.json &&
  quadtune export out/quad-450.json --to px4 --vehicle $vehicle -o out/quad-450-px4 &&
  quadtune verify out/quad-450-px4 --vehicle $vehicle"

say "an example, with pkg-config and with CMake"
example=/usr/share/doc/quadtune/examples/own_vehicle.cpp
quietly inside sh -c "cd /root/work && g++ -std=c++20 -O1 $example -o example \$(pkg-config --cflags --libs quadtune)"
mkdir "$root/root/work/example.cmake"
cat >"$root/root/work/example.cmake/CMakeLists.txt" <<TEXT
cmake_minimum_required(VERSION 3.25)
project(example LANGUAGES CXX)
find_package(quadtune REQUIRED)
add_executable(example $example)
target_link_libraries(example PRIVATE quadtune::workbench)
TEXT
quietly inside sh -c 'cd /root/work/example.cmake && cmake -S . -B build && cmake --build build'
for program in example example.cmake/build/example; do
  quietly inside "/root/work/$program" mambo
  grep -qi 'pass' "$work/output" || fail "$program reports no passed hover"
  ! grep -qiw 'nan' "$work/output" || fail "$program prints NaN"
done

if has python3-quadtune; then
  say "the tests of the Python module"
  module=/usr/lib/python3/dist-packages/quadtune
  for file in __init__.py __init__.pyi py.typed; do
    [ -f "$root$module/$file" ] || fail "$module/$file is missing"
  done
  # What the tests read beside themselves.
  mkdir -p "$root/root/work/sources/docs" "$root/root/work/sources/tests"
  (cd "$here/../.." && cp -r campaigns designs python vehicles "$root/root/work/sources")
  cp -r "$here/../../docs/examples" "$root/root/work/sources/docs"
  cp -r "$here/../python" "$root/root/work/sources/tests"
  for test in "$here"/../python/test_*.py; do
    test=${test##*/}
    status=0
    inside env -C /root/work/sources QUADTUNE=/usr/bin/quadtune PYTHONDONTWRITEBYTECODE=1 \
      OPENBLAS_NUM_THREADS=1 python3 tests/python/run_tests.py "$test" >"$work/output" 2>&1 ||
      status=$?
    case $status in
      0) say "  $test: $(tail -n 1 "$work/output")" ;;
      77) say "  $test: $(head -n 1 "$work/output")" ;;
      *) tail -n 60 "$work/output" && fail "$test failed" ;;
    esac
  done
fi

say "removing them"
quietly inside apt-get purge -y -q "${names[@]}"
files_inside >"$work/after"
if ! diff "$work/before" "$work/after" >"$work/difference"; then
  cat "$work/difference"
  fail "removing the packages did not restore the files above"
fi
! diff -q "$work/before" "$work/installed" >/dev/null || fail "the list of files does not show what is installed"
! inside dpkg -l | grep quadtune || fail "dpkg still knows packages of quadtune"
! inside ldconfig -p | grep quadtune || fail "the loader still knows libraries of quadtune"
