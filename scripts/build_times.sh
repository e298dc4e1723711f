#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Where a build's time went: scripts/build_times.sh build/timed/.ninja_log
# Processor time of each folder, and of the source files that took longest.
set -euo pipefail

awk -F '\t' '
  NF == 5 && $4 ~ /\.(o|gch)$/ {
    name = $4
    sub(/CMakeFiles\/[^\/]*\.dir\//, "", name)
    sub(/\.(o|gch)$/, "", name)
    # lib/quadtune_lib_batches/in_logs_0.cpp, which includes sources of lib/logs, counts as lib/logs/_0.cpp.
    if (sub(/[a-z_]*_batches\/in_/, "", name)) sub(/_[0-9]+\.cpp$/, "/&", name)
    folder = name
    if (!sub(/\/[^\/]*$/, "", folder)) folder = "."
    seconds = ($2 - $1) / 1000
    time[folder] += seconds
    ++count[folder]
    of[name] = seconds
    total += seconds
    ++files
  }
  END {
    printf "%-28s %6s %10s\n", "folder", "files", "s"
    order = "sort -k3,3nr"
    for (folder in time) printf "%-28s %6d %10.1f\n", folder, count[folder], time[folder] | order
    close(order)
    printf "%-28s %6d %10.1f\n\n", "sum", files, total
    printf "%-62s %8s\n", "the 20 files that take longest", "s"
    order = "sort -k2,2nr | head -n 20"
    for (name in of) printf "%-62s %8.1f\n", name, of[name] | order
    close(order)
  }
' "$1"
