#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A campaign on a disk that fills up, a small private one in memory: the full disk is reported,
# no flown flight is lost, and with more space the bytes are those of a large disk.
# usage: campaign_full_disk_test.sh PROGRAM
set -euo pipefail
program=$1
if [ "${2:-}" != mounted ]; then
  # A separate mount name space: root may create one, other users with themselves as its root.
  own=(unshare --mount)
  [ "$(id -u)" = 0 ] || own=(unshare --user --map-root-user --mount)
  "${own[@]}" sh -c 'mount -t tmpfs -o size=64k quadtune-test /mnt' 2>/dev/null || {
    echo "skipped: no file system can be mounted here"
    exit 77
  }
  exec "${own[@]}" "$0" "$program" mounted
fi
work=$(mktemp -d)
trap 'umount "$work/disk" 2>/dev/null || true; rm -rf "$work"' EXIT
here=$(dirname "$0")
# shellcheck source=tests/cli/campaign/campaign_file.sh
. "$here/campaign_file.sh"
mkdir "$work/disk"
mount -t tmpfs -o size=16m quadtune-test "$work/disk"
# Leaves this number of kB free: ballast fills the rest, since not every user may change the size.
room() {
  rm -f "$work/disk/ballast"
  fallocate -l $(($(df --output=avail -k "$work/disk" | tail -n 1) - $1))K "$work/disk/ballast"
}
files() { find "$work/disk/c" -type f | wc -l; }

# Runs a command that must report a full disk for a file: status 5, one line, no output.
full_at() {
  local name=$1 status=0
  shift
  "$program" campaign "$@" >"$work/out" 2>"$work/err" || status=$?
  cat "$work/err"
  [ $status = 5 ] || { echo "$1 ended with $status, expected 5" && exit 1; }
  [ "$(wc -l <"$work/err")" = 1 ] || { echo "more or less than a line" && exit 1; }
  grep -Eq "$name: .*(No space left on device|disk is full)" "$work/err" ||
    { echo "it does not name $name" && exit 1; }
  [ ! -s "$work/out" ] || { echo "it printed as if all were well" && exit 1; }
}

# Full during the flights: 4096 records are 900 kB. A second run keeps the existing records.
room 300
"$program" campaign init "$work/campaign.toml" "$work/disk/c"
full_at '[.]part' work "$work/disk/c" --shard 0
before=$(files)
full_at '[.]part' work "$work/disk/c" --shard 0
[ "$(files)" = "$before" ] || { echo "a second try left files" && exit 1; }
"$program" campaign status "$work/disk/c" | tee "$work/status"
grep -Eq 'stopped|running' "$work/status" || { echo "status does not report it" && exit 1; }

# Space for all records, but not twice: full when the file of the shard is written.
room 800
full_at '[.]part' work "$work/disk/c" --shard 0
before=$(files)
full_at '[.]part' work "$work/disk/c" --shard 0
[ "$(files)" = "$before" ] || { echo "a second try left files" && exit 1; }
room 1000
"$program" campaign work "$work/disk/c" --shard 0 | tee "$work/last"
grep -q '^shard 0: 0 flown, 4096 found$' "$work/last" || { echo "flights were lost" && exit 1; }

# Full during the merge, which leaves no partial files.
full_at '(flights.csv|campaign.sqlite)' merge "$work/disk/c"
[ -z "$(find "$work/disk/c" -name '*.quadtune-tmp')" ] || { echo "it left a part of a table" && exit 1; }
rm "$work/disk/ballast"
"$program" campaign merge "$work/disk/c" >/dev/null

"$program" campaign run "$work/campaign.toml" "$work/alone" >/dev/null
[ "$(merged "$work/disk/c")" = "$(merged "$work/alone")" ] || { echo "other bytes" && exit 1; }
echo "a full disk loses nothing"
