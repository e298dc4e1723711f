#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A signal at any moment ends the program with `interrupted` and
# status 130, one line and, with --json, one JSON object; no partial files are left.
# usage: stop_signals_test.sh PROGRAM
set -uo pipefail
program=$1
work=$(mktemp -d)
waiting=
trap '[ -z "$waiting" ] || kill "$waiting"; rm -rf "$work"' EXIT
cd "$work" || exit 1
RANDOM=1

# Pipes that stay open without data.
mkfifo silent named.toml named.csv full
sleep 1000 >silent 2>/dev/null &
waiting=$!

# A matrix of N rows with random entries.
matrix() {
  awk -v n="$1" -v m="$2" -v seed="$3" 'BEGIN { srand(seed)
    for (i = 0; i < n; i++) { for (j = 0; j < m; j++) printf "%.3f ", rand() - 0.5; print "" } }'
}
matrix 600 600 1 >A
matrix 600 2 2 >B
awk 'BEGIN { for (i = 0; i < 600; i++) { for (j = 0; j < 600; j++) printf "%d ", i == j; print "" } }' >Q
printf '1 0\n0 1\n' >R
awk 'BEGIN { print "t_s,gx[rad/s]"; srand(3)
  for (i = 0; i < 400000; i++) printf "%.3f,%.5f\n", i * 0.005, rand() }' >long.csv

# The signals are caught, and the process is no longer a copy of this shell.
is_ready() {
  [ "$(cat "/proc/$1/comm" 2>/dev/null)" = quadtune ] || return 1
  local caught
  caught=$(awk '/^SigCgt/ { print $2 }' "/proc/$1/status" 2>/dev/null) || return 1
  [ -n "$caught" ] && (((0x$caught & 0x4000) != 0))
}

failures=0
fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# stops NAME STDIN ARGS...: starts the program, sends it a signal at a random moment, and checks the result.
# A program that ends before the signal must end with 0, 1 or 4.
stops() {
  local name=$1 stdin=$2 signal pid guard status
  shift 2
  signal=$([ $((RANDOM % 2)) = 0 ] && echo INT || echo TERM)
  "$program" "$@" <"$stdin" >out.txt 2>err.txt &
  pid=$!
  (sleep 300 && kill -KILL $pid) >/dev/null 2>&1 &
  guard=$!
  while kill -0 $pid 2>/dev/null && ! is_ready $pid; do sleep 0.01; done
  sleep "0.$((RANDOM % 6))"
  kill -"$signal" $pid 2>/dev/null
  wait $pid
  status=$?
  pkill -P $guard
  wait $guard 2>/dev/null
  echo "$name: SIG$signal, status $status: $(head -c 100 err.txt | tr '\n' '|')"
  case $status in
    130)
      [ "$(grep -c interrupted err.txt)" = 1 ] || fail "$name: $(cat err.txt)"
      if [[ " $* " == *" --json "* ]] && ! grep -q '"code":130' out.txt; then
        fail "$name: no JSON: $(cat out.txt)"
      fi
      ;;
    0 | 1 | 4) [ "$name" != wait ] || fail "$name: status $status, expected 130" ;;
    *) fail "$name: status $status: $(cat err.txt)" ;;
  esac
}

repeats=${QUADTUNE_REPEATS:-1}
for ((i = 0; i < repeats; i++)); do
  stops wait silent lqr --A - --B B --Q Q --R R
  stops wait silent lqr --A - --B B --Q Q --R R --json
  stops wait silent log -
  stops wait /dev/null vehicle check named.toml
  stops wait /dev/null log named.csv --json
  stops wait /dev/null allan --log named.csv --column gx
  stops wait /dev/null lqr --A named.csv --B B --Q Q --R R
  stops wait /dev/null link send land --firmware native --to 127.0.0.1:1 --timeout 60 --tries 100
  stops compute /dev/null lqr --A A --B B --Q Q --R R --json
  stops compute /dev/null kalman --A A --C Q --Q Q --R Q --discrete
  stops compute /dev/null discretize --A A --B B --dt 0.1 --method foh
  stops compute /dev/null allan --log long.csv --column gx
  stops compute /dev/null log long.csv
  stops compute /dev/null pid uquad
  stops compute /dev/null fly mambo --mission lemniscate --duration 600
  stops compute /dev/null lqr mambo --schedule "speed=0:0.5:10, yaw_rate=-2:0.1:2" --json
done

# A reader that reads nothing, so that standard output is full.
# shellcheck disable=SC2217
sleep 1000 <full &
reader=$!
"$program" discretize --A A --B B --dt 0.1 --json >full 2>err.txt &
pid=$!
while kill -0 $pid 2>/dev/null && ! is_ready $pid; do sleep 0.01; done
sleep 3
kill -TERM $pid
wait $pid
status=$?
kill $reader
[ $status = 130 ] || fail "a full pipe: status $status"
[ "$(tail -n 1 err.txt)" = interrupted ] || fail "a full pipe: $(cat err.txt)"

# The folder of a campaign has no partial files, and the campaign can be continued.
cat >campaign.toml <<'TOML'
name = "stopped"
vehicle = "mambo"
flights = 2000
[[design]]
gains = "published"
[[mission]]
mission = "hover"
duration_s = 3
[[vary]]
quantity = "mass"
normal = { deviation = 0.05, least = 0.8, most = 1.2 }
TOML
stops compute /dev/null campaign run campaign.toml flown
[ -z "$(find . -name '.*.quadtune-tmp')" ] ||
  fail "a temporary file was left"

[ $failures = 0 ] || exit 1
echo "signals end everything"
