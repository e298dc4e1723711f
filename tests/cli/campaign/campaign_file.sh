# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A small campaign and its bytes from one process, for tests with job systems and full disks.
# To be sourced, with the variables program and work.

work=${work:?}

# The campaign file: 4096 short hovers.
cat >"$work/campaign.toml" <<'TOML'
name = "engines"
vehicle = "mambo"
flights = 4096
seed = 5
[[design]]
gains = "published"
[[mission]]
mission = "hover"
duration_s = 3
[[vary]]
quantity = "mass"
normal = { deviation = 0.05, least = 0.8, most = 1.2 }
[keep]
failures = 0
TOML

# The merged results, which must not depend on how they were computed.
merged() { (cd "$1" && sha256sum flights.csv campaign.sqlite); }

# Writes a program that behaves like quadtune, except that the first worker of a shard is killed in
# the middle, with records on disk; the marker WORK/killed records this. It kills its own child and
# checks how that ended: if the child finished first, e.g. on a busy machine, its files are removed
# and it is started again. Then the program ends itself by the same signal,
# which is what a job system sees.
# usage: program_killed_once SHARD FILE
program_killed_once() {
  cat >"$2" <<SCRIPT
#!/usr/bin/env bash
set -u
program='${program:?}' work='$work' shard=$1
SCRIPT
  cat >>"$2" <<'SCRIPT'
[ "$1 $2 $4 $5" = "campaign work --shard $shard" ] && mkdir "$work/begun" 2>/dev/null ||
  exec "$program" "$@"
files=$3/0000$shard
# A header and one complete record.
has_records() { [ -n "$(find "$3" -name "0000$shard.*.part" -size +600c)" ]; }
while true; do
  "$program" "$@" >"$work/killed.txt" 2>&1 &
  worker=$!
  until has_records "$@" || ! kill -0 $worker 2>/dev/null; do sleep 0.01; done
  kill -KILL $worker 2>/dev/null
  status=0
  wait $worker || status=$?
  [ $status != 137 ] || [ -f "$files.flights" ] || ! has_records "$@" || break
  [ $status = 137 ] || [ $status = 0 ] || { cat "$work/killed.txt" && exit $status; }
  rm -f "$files".*
done
touch "$work/killed"
kill -KILL $$
SCRIPT
  chmod +x "$2"
}
