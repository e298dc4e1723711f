# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A small campaign and its bytes from one process, for tests of the engines of clusters and of disks.
# Sourced with: program, work.

work=${work:?}

# The file of the campaign: 4096 short hovers.
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

# What came out, whatever the way there.
merged() { (cd "$1" && sha256sum flights.csv campaign.sqlite); }

# Writes a program that does what quadtune does, but the first worker of a shard is killed in the
# middle, with records on disk; the marker WORK/killed tells that it was. It kills a child of its own
# and looks at how that ended: one that was done first, as on a machine that is busy with other
# things, has its files taken away and is started afresh. Then it ends by the same signal itself,
# which is what an engine sees.
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
# A header, and a record that is whole.
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
