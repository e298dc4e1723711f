#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The shards of a campaign by GNU parallel: a worker is killed in the middle, the script is called again;
# the merged result is that of one process.
# usage: campaign_parallel_test.sh PROGRAM
set -euo pipefail
program=$1
command -v parallel >/dev/null || {
  echo "skipped: no GNU parallel here (Debian's parallel)"
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
here=$(dirname "$0")
# shellcheck source=tests/cli/campaign/campaign_file.sh
. "$here/campaign_file.sh"

"$program" campaign init "$work/campaign.toml" "$work/shared" --shards 8
program_killed_once 2 "$work/quadtune"
export QUADTUNE=$work/quadtune HOME=$work
mkdir -p "$work/.parallel" && touch "$work/.parallel/will-cite"
if "$work/shared/parallel.sh" >"$work/first.txt" 2>&1; then
  echo "parallel did not see that a worker was killed"
  exit 1
fi
[ -f "$work/killed" ] || { cat "$work/first.txt" && exit 1; }
"$work/shared/parallel.sh" >"$work/second.txt" 2>&1
cat "$work/second.txt"
# The second call flies only the shard that failed.
[ "$(grep -c '^shard' "$work/second.txt")" = 1 ] || { echo "it flew more than what failed" && exit 1; }
"$program" campaign merge "$work/shared" >/dev/null

"$program" campaign run "$work/campaign.toml" "$work/alone" --shards 3 >/dev/null
[ "$(merged "$work/shared")" = "$(merged "$work/alone")" ] || { echo "other bytes" && exit 1; }
echo "parallel gives the bytes of one process"
