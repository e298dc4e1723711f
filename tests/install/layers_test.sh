#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Which layer includes which: layers_test.sh SOURCE. The compiler and the linker separate the shared
# libraries; report/ and cli/ are static and see the root of the sources, so this test examines them
# too.
set -euo pipefail
cd "$1"
bad=0

# refuse FOLDER PATTERN WHY: fails if a source of the folder includes a match.
refuse() {
  if grep -rnE "#include [<\"]$2" "$1" --include='*.cpp' --include='*.hpp'; then
    echo "$1/ includes the above: $3"
    bad=1
  fi
}

refuse report '(cli|arguments|program)/' 'results know nothing of command lines'
for folder in lib linearize discretize synthesis tuning exports workbench; do
  refuse $folder '(report|cli)/' 'libraries print nothing'
done
for folder in lib linearize discretize synthesis tuning exports; do
  refuse $folder 'quadtune/workbench/' 'the workbench stands above them'
done
refuse lib 'quadtune/(linearize|discretize|synthesis|tuning|exports)/' 'lib stands below all'
refuse synthesis 'quadtune/(tuning|exports)/' 'they stand above or beside it'
refuse exports 'quadtune/(linearize|discretize|synthesis|tuning)/' 'it stands beside them'
exit $bad
