#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The size of the project: lines, folders, headers and long functions. ./dev stats runs it.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

# Tracked files of our own: nothing that others wrote.
ours() { git ls-files -- "$@" | grep -v '/vendor/'; }

lines() { ours "$@" | tr '\n' '\0' | xargs -0 -r cat | wc -l; }

printf '%-34s %8s\n' 'lines' ''
for folder in lib linearize discretize synthesis tuning exports workbench report cli benchmarks examples; do
  [ -d "$folder" ] || continue
  printf '  %-32s %8d\n' "$folder" "$(lines "$folder/*.cpp" "$folder/*.hpp" "$folder/*.js" "$folder/*.css" "$folder/*.html")"
done
printf '  %-32s %8d\n' 'sum without tests' \
  "$(lines '*.cpp' '*.hpp' '*.js' '*.css' '*.html' ':!tests')"
printf '  %-32s %8d\n' 'tests' "$(lines 'tests/*.cpp' 'tests/*.hpp' 'tests/*.sh')"
printf '  %-32s %8d\n' 'prose' "$(lines '*.md')"

printf '%-34s %8d\n' 'public headers' "$(ours '*/include/*.hpp' | wc -l)"

# Sources of its own: without those in folders below.
printf 'folders with more than 25 sources\n'
ours '*.cpp' '*.hpp' | sed 's|/[^/]*$||' | sort | uniq -c | sort -rn |
  awk '$1 > 25 { printf "  %-32s %8d\n", $2, $1 }'

# A function begins with a line that ends in a brace, and ends where as many braces are closed. Texts
# with a brace alone are rare enough not to count.
printf 'functions of more than 50 lines\n'
ours '*.cpp' '*.hpp' ':!tests' | while read -r file; do
  awk -v file="$file" '
    { line = $0; sub(/\/\/.*/, "", line); opened = gsub(/\{/, "{", line); closed = gsub(/\}/, "}", line) }
    !inside && /^ *[A-Za-z_~:].*[)a-z] \{$/ &&
        !/^ *(export |inline )?(namespace|struct|class|enum|union|extern|else|if|for|while|switch|do|try)( |$)/ {
      inside = 1; at = NR; depth = 0
    }
    inside {
      depth += opened - closed
      if (depth <= 0) {
        if (NR - at + 1 > 50) printf "  %s:%d: %d lines\n", file, at, NR - at + 1
        inside = 0
      }
    }
  ' "$file"
done | sort -t: -k3,3nr
