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

# Waits until a file has more bytes than a number.
wait_for_more_than() {
  local bytes=$1 file=$2
  for _ in $(seq 6000); do
    # shellcheck disable=SC2086  # a pattern
    for found in $file; do
      [ ! -f "$found" ] || [ "$(stat -c %s "$found" 2>/dev/null || echo 0)" -le "$bytes" ] || return 0
    done
    sleep 0.01
  done
  echo "waited for $file in vain"
  return 1
}

# Kills the worker that writes a part, which its name tells: SHARD.HOST-PROCESS-TIME.part
kill_writer_of() {
  local part=$1 process
  process=${part%-*.part}
  process=${process##*-}
  grep -qa campaign "/proc/$process/cmdline" && kill -KILL "$process"
}
