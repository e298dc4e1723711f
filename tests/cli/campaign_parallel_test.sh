#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A campaign's shards by GNU parallel: a worker is killed in the middle, the script called again;
# what is merged is what one process gives.
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
# shellcheck source=tests/cli/campaign_file.sh
. "$here/campaign_file.sh"

"$program" campaign init "$work/campaign.toml" "$work/shared" --shards 8
export QUADTUNE=$program HOME=$work
mkdir -p "$work/.parallel" && touch "$work/.parallel/will-cite"
"$work/shared/parallel.sh" >"$work/first.txt" 2>&1 &
first=$!
wait_for_more_than 64 "$work/shared/00002.*.part"
kill_writer_of "$work"/shared/00002.*.part || { echo "no worker to kill" && exit 1; }
[ ! -f "$work/shared/00002.flights" ] || { echo "it was complete before it was killed" && exit 1; }
if wait $first; then
  echo "parallel did not see that a worker was killed"
  exit 1
fi
"$work/shared/parallel.sh" >"$work/second.txt" 2>&1
cat "$work/second.txt"
# What failed, and nothing else.
[ "$(grep -c '^shard' "$work/second.txt")" = 1 ] || { echo "it flew more than what failed" && exit 1; }
"$program" campaign merge "$work/shared" >/dev/null

"$program" campaign run "$work/campaign.toml" "$work/alone" --shards 3 >/dev/null
[ "$(merged "$work/shared")" = "$(merged "$work/alone")" ] || { echo "other bytes" && exit 1; }
echo "parallel gives the bytes of one process"
