#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs an example and checks what it prints: example_test.sh PROGRAMS SOURCE NAME
# PROGRAMS is the folder of the compiled examples. Where the output is not the same on every machine, down to the
# last digit, facts are checked instead.
# shellcheck disable=SC2016 # the $ are AWK's
set -euo pipefail
programs=$1 source=$2 name=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

wrong() {
  echo "$name: $1; it printed:"
  cat "$work/output" "$work/errors"
  exit 1
}

# run STATUS ARGUMENT...: the exit status is as expected. With 2 there is one line on the error stream and
# nothing else; otherwise there are lines without NaN, and nothing on the error stream.
run() {
  local expected=$1 status=0
  shift
  "$programs/$name" "$@" >"$work/output" 2>"$work/errors" || status=$?
  [ "$status" = "$expected" ] || wrong "exit status $status with arguments '$*', expected $expected"
  if [ "$expected" = 2 ]; then
    [ "$(grep -c "^$name: ." "$work/errors")" = "$(wc -l <"$work/errors")" ] || wrong "expected one line of errors"
    [ "$(wc -l <"$work/errors")" = 1 ] || wrong "expected one line of errors"
    return
  fi
  [ -s "$work/output" ] || wrong "expected output"
  [ ! -s "$work/errors" ] || wrong "expected an empty error stream"
  ! grep -qiw 'nan\|-nan' "$work/output" || wrong "expected numbers, not NaN"
}

# fact WHAT PROGRAM: an AWK program over the lines of the output has the exit status 0.
fact() { awk "$2" "$work/output" || wrong "expected $1"; }

case $name in
  own_vehicle)
    run 0
    fact 'poles inside the unit circle' '/^crazyflie: largest / { z = $NF } END { exit !(0 < z && z < 1) }'
    fact 'four loops with a phase margin of at least 30 degrees' \
      '/phase margin/ { n += $8 >= 30 } END { exit n != 4 }'
    fact 'a hover with its own sensors that passes' '/^hover, real sensors/ { ok = /: pass$/ } END { exit !ok }'
    run 2 no-such-vehicle
    ;;
  lqg_margins)
    run 0
    # The textbook: each input of an LQR has 60 degrees and |1 + L| >= 1, whatever the plant.
    fact 'the guaranteed margins of an LQR' \
      '/^LQR/ { n += $5 >= 60 && $9 <= 1.0001 } END { exit n != 4 }'
    fact 'that the filter costs margin at every input' \
      '/^LQR/ { peak[$2] = $9 } /^LQG/ { n += $9 > peak[$2] && $5 > 0 } END { exit n != 4 }'
    # The separation principle.
    fact 'the slowest pole to be that of regulator or filter' \
      '/^slowest/ { s = $7 > $10 ? $7 : $10; d = $4 / s - 1 }
       END { exit !(s < 0 && -1e-4 < d && d < 1e-4) }'
    run 2 no-such-vehicle
    ;;
  schedule)
    run 0 "$work/table.toml"
    diff "$source/tests/examples/schedule.txt" "$work/output" || wrong "expected tests/examples/schedule.txt"
    [ "$(grep -c '^\[\[point' "$work/table.toml")" = 6 ] || wrong "expected a table of 6 points"
    run 2 "$work/table.csv"
    ;;
  noise_from_log)
    # docs/examples/bobbing.csv was made with a noise density of 0.01 m2/s3 and echoes of variance 0.0004 m2.
    run 0 "$source/docs/examples/bobbing.csv"
    fact 'intervals that hold the noise that made the log' \
      '/^Q.az:/ { n += $7 < 0.01 && 0.01 < $9 } /^R.sonar:/ { n += $7 < 4e-4 && 4e-4 < $9 } END { exit n != 2 }'
    fact 'consistent innovations' '/mean of e/ { s = $6 } END { exit !(0.8 < s && s < 1.25) }'
    fact 'the verdict pass' '/^verdict: pass$/ { ok = 1 } END { exit !ok }'
    head -n 100 "$source/docs/examples/bobbing.csv" >"$work/short.csv"
    run 1 "$work/short.csv"
    run 2 "$work/missing.csv"
    ;;
  campaign)
    run 0 40
    cp "$work/output" "$work/first"
    fact 'a success rate within its interval' \
      '/flights passed/ { d = $6 - $1 / $3; ok = $3 == 40 && $10 <= $6 + 0 && $6 + 0 <= $12 && d * d < 1e-10 }
       END { exit !ok }'
    run 0 40
    diff "$work/first" "$work/output" || wrong "expected the same flights from the same seed"
    run 2 many
    ;;
  own_estimator)
    run 0
    fact 'an error below 1 cm' '/rms/ { e = $4 } END { exit !(0 < e && e < 0.01) }'
    ;;
  own_law)
    run 0
    fact 'a step of one metre that settles' '/^settling_time:/ { ok = $2 > 0.5 && $2 < 8 } END { exit !ok }'
    run 0 lemniscate
    run 2 no-such-mission
    ;;
  own_exporter)
    run 0 "$work/export"
    fact 'checks, all of which pass' '/^pass: / { n++ } /^FAIL/ { bad = 1 } END { exit bad || n < 5 }'
    awk 'NR > 1 && NF == 12 { n++ } END { exit n != 4 || NR != 5 }' "$work/export/K.txt" ||
      wrong "expected 4 rows of 12 gains"
    touch "$work/file"
    run 2 "$work/file/export"
    ;;
  pendulum_filter)
    run 0
    # The camera alone has 0.005 m / 0.7 m = 0.0071 rad.
    fact 'an error below that of the camera alone' '/^angle/ { e = $4 } END { exit !(0 < e && e < 0.006) }'
    fact 'consistent innovations' '/^mean of e/ { s = $4 } END { exit !(0.9 < s && s < 1.1) }'
    ;;
  *) echo "example_test.sh: no example '$name'" >&2 && exit 2 ;;
esac
