#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The program with each variant of its libraries that this machine can run: variants_test.sh
# PROGRAM. It must report the loaded variant, and a flight must have the same bytes with each of
# them.
set -euo pipefail
program=$1
loader=$(readelf -l "$program" | sed -n 's/.*program interpreter: \(.*\)\]/\1/p')
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The variants that the loader would select here, and the name of each in `quadtune --version`.
names=(none baseline)
for variant in "x86-64-v3 AVX2" "x86-64-v4 AVX-512"; do
  if "$loader" --help | grep -q "${variant% *} (supported"; then
    names+=("${variant% *}" "${variant#* }")
  fi
done

# The laws that all variants fly, designed by one of them, because kernels that solve equations
# agree only up to rounding.
here=$(dirname "$(readlink -f "$0")")
cp "$here/../../vehicles/hexa-550.toml" "$work"
cd "$work"
for vehicle in mambo crazyflie uquad hexa-550.toml; do
  "$loader" --glibc-hwcaps-mask none "$program" pid "$vehicle" --json --quiet >"$vehicle.json"
done

fly() { # VARIANT VEHICLE ESTIMATOR
  "$loader" --glibc-hwcaps-mask "$1" "$program" fly "$2" --gains "$2.json" \
    --mission step-north --duration 4 --estimator "$3" --wind light \
    --log "$1-$2-$3.csv" --quiet >/dev/null 2>&1 || [ $? = 1 ]
}

for ((i = 0; i < ${#names[@]}; i += 2)); do
  variant=${names[i]}
  said=$("$loader" --glibc-hwcaps-mask "$variant" "$program" --version | sed -n 's/^kernels: //p')
  [ "$said" = "${names[i + 1]}" ] || {
    echo "with the variant $variant: kernels are '$said', expected '${names[i + 1]}'"
    exit 1
  }
  for flight in "mambo mambo" "mambo general" "crazyflie general" "uquad uquad" \
    "hexa-550.toml general"; do
    # shellcheck disable=SC2086 # two words
    fly "$variant" $flight
    first=none-${flight% *}-${flight#* }.csv
    cmp "$first" "$variant-${flight% *}-${flight#* }.csv"
    [ "$(wc -l <"$first")" -gt 300 ]
  done
done
echo "same flights with $((${#names[@]} / 2)) variants"
