#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# licences_test.sh PROGRAM SOURCE: the table under "## Licence" of docs/licences.md names every library that
# the program needs, its own and theirs, and every library whose headers are compiled in.
#
# It may name more, e.g. other builds of one library.
set -euo pipefail
program=$1
source=$2
section=$(sed -n '/^## Licence/,/^## /p' "$source/docs/licences.md")
failed=0

# named WORD WHERE: a row of the table has the word in backticks or as its first column.
named() {
  local word
  word=${1//./\\.}
  word=${word//+/\\+}
  if ! grep -E '^\|' <<<"$section" | grep -qE "\`$word\`|^\| ([^|]*[ ,])?${word}[ ,|]"; then
    echo "README.md: the table of licences lacks $1 ($2)"
    failed=1
  fi
}

declare -A path=() seen=()
needs_of() {
  while read -r name arrow file _; do
    if [[ $arrow == "=>" && -e $file ]]; then path[$name]=$file; fi
  done < <(ldd "$1")
}
needs_of "$program"

# Breadth first over the direct dependencies of each file.
queue=("$program")
while ((${#queue[@]} > 0)); do
  file=${queue[0]}
  queue=("${queue[@]:1}")
  while read -r name; do
    if [[ -n ${seen[$name]:-} ]]; then continue; fi
    seen[$name]=1
    if [[ -n ${path[$name]:-} ]]; then queue+=("${path[$name]}"); fi
    if [[ $name != libquadtune_* ]]; then named "${name%%.so*}" "needed by $(basename "$file")"; fi
  done < <(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
done
if ((${#seen[@]} < 10)); then
  echo "only ${#seen[@]} libraries found: ldd or readelf did not work"
  exit 1
fi

# Libraries that are linked statically, or compiled in from headers.
while read -r prefix word; do
  if grep -rqE "#include <$prefix" --include='*.cpp' --include='*.hpp' \
    "$source"/{lib,linearize,discretize,synthesis,tuning,exports,workbench,cli}; then
    named "$word" "headers <$prefix...>"
  fi
done <<'PARTS'
Eigen/ Eigen
boost/ Boost
ceres/ Ceres
nlopt NLopt
cholmod CHOLMOD
CLI/ CLI11
nlohmann/ nlohmann-json
fmt/ fmt
toml\+\+/ toml++
openssl/ OpenSSL
sqlite3 SQLite
lapacke LAPACKE
zlib zlib
PARTS

# Each row says under which licence.
while IFS='|' read -r _ part _ _ licence _; do
  if [[ -z ${licence// /} ]]; then
    echo "README.md: no licence for$part"
    failed=1
  fi
done < <(grep -E '^\|' <<<"$section" | tail -n +3)
exit $failed
