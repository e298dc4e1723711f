#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# example_test.sh PROGRAM SOURCE all|short: what the example prints, and how it ends; for one vehicle
# or for several.
set -uo pipefail
program=$1
source=$2
status=0

# expect STATUS PATTERN WORD...: the program with these words ends so and prints a line that fits.
expect() {
  local wanted=$1 pattern=$2 output came
  shift 2
  output=$("$program" "$@" 2>&1)
  came=$?
  echo "$output"
  if [ "$came" != "$wanted" ] || ! grep -Eq "$pattern" <<<"$output"; then
    echo "$*: ended with $came, expected $wanted and a line '$pattern'"
    status=1
  fi
}

expect 0 '^hover, real sensors, estimator general: pass$'
if [ "$3" != short ]; then
  expect 0 '^  T: gain margin .* dB, phase margin .* deg, delay margin .* ms$' rolling-spider
  expect 0 '^crazyflie: largest [|]z[|] 0[.]99' "$source/vehicles/crazyflie.toml"
  # Its hover is judged by what satellite fixes of half a metre allow; a gust and a load come after it.
  expect 0 '^hover, real sensors, estimator general: pass$' uquad
fi
expect 2 '^own_vehicle: .*no-such' no-such.toml
exit $status
