#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Imports the module from an installed tree: check_installed.sh PYTHON PREFIX VERSION
set -euo pipefail
python=$1 prefix=$2 version=$3
"$python" -c 'import numpy' 2>/dev/null || {
  echo "skipped: no NumPy here (Debian's python3-numpy)"
  exit 77
}
module=$(find "$prefix" -path '*/dist-packages/quadtune/__init__.py')
[ -n "$module" ] || { echo "no module below $prefix" && exit 1; }
folder=$(dirname "$(dirname "$module")")
output=$(cd / && PYTHONPATH=$folder "$python" -c '
import quadtune
maps = open("/proc/self/maps").read()
libraries = {line.split()[-1] for line in maps.splitlines() if "libquadtune_workbench" in line}
print(quadtune.__version__, quadtune.vehicle("mambo").name, *sorted(libraries))')
echo "$output"
case $output in
  "$version mambo $prefix"/*) ;;
  *) echo "expected: $version mambo $prefix/..." && exit 1 ;;
esac
