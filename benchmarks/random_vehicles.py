#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the flights that pass with the default gains of random vehicles:

    random_vehicles.py PROGRAM [--count 40] [--seed 200] [--to json] [--without-lead]

Each vehicle is written by `quadtune vehicle new` from random numbers: 40 g to 9 kg, 4, 6 or 8 rotors
in X or plus, a disk loading of 30 to 150 N/m², a thrust-to-weight ratio of 1.6 to 4.5, a motor lag
that is estimated or 0.1 to 0.25 s per metre of propeller, and optical flow or a satellite receiver.
`quadtune design` computes its gains, for a firmware with --to, and `quadtune fly` flies ten missions
with five seeds each. Firmware other than PX4 gets four rotors, of which the first turns clockwise,
as its mixer requires. With --without-lead the gains are those of `quadtune pid` without a lead.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

MISSIONS = ["hover", "step-north", "step-east", "step-height", "step-yaw", "take-off-and-land",
            "waypoints", "circle", "lemniscate", "line"]
SEEDS = 5


def new_vehicle(seed, fixed_mixer=False):
    """The name of a random vehicle, and the options of `vehicle new`."""
    draw = random.Random(seed)
    mass = math.exp(draw.uniform(math.log(0.04), math.log(9)))
    rotors = draw.choice([4, 4, 4, 6, 8])
    if fixed_mixer:
        rotors = 4
    loading = math.exp(draw.uniform(math.log(30), math.log(150)))
    propeller = 2 * math.sqrt(mass * 9.81 / loading / rotors / math.pi)
    # Neighbouring propellers are apart.
    half_angle = math.sin(math.pi / rotors)
    arm = max(1.05 * propeller * draw.uniform(0.6, 1) / (2 * half_angle), 0.52 * propeller / half_angle)
    options = [
        f"v{seed}", "--mass", f"{mass:.4f}kg", "--arm", f"{arm:.4f}m", "--propeller",
        f"{propeller:.4f}m", "--thrust-to-weight", f"{draw.uniform(1.6, 4.5):.2f}", "--rotors",
        str(rotors), "--layout", draw.choice(["x", "plus"]), "--spin", draw.choice(["cw", "ccw"]),
        "--sensors", draw.choice(["gps", "flow"])]
    if fixed_mixer:
        options[options.index("--spin") + 1] = "cw"
    if mass < 0.12 and draw.random() < 0.5:
        options.append("--brushed")
    if draw.random() < 0.5:
        options += ["--lag", f"{max(8, 1000 * draw.uniform(0.1, 0.25) * propeller):.0f}ms"]
    return f"{mass:.3f} kg, {rotors} rotors of {propeller:.3f} m, {options[16]}", options


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=200)
    parser.add_argument("--to", default="json")
    parser.add_argument("--without-lead", action="store_true")
    asked = parser.parse_args()

    def run(*words):
        return subprocess.run([asked.program, *map(str, words), "--quiet"], capture_output=True,
                              text=True, check=False)

    passed = flown = complete = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(asked.seed, asked.seed + asked.count):
            about, options = new_vehicle(seed, asked.to not in ("json", "c", "px4"))
            vehicle = pathlib.Path(folder) / f"v{seed}.toml"
            made = run("vehicle", "new", *options, "-o", vehicle)
            if made.returncode == 0:
                gains = vehicle.with_suffix(".json" if asked.without_lead else "")
                made = (run("pid", vehicle, "-o", gains) if asked.without_lead else
                        run("design", vehicle, "--to", asked.to, "--seeds", 1, "-o", gains))
            reasons = [] if made.returncode == 0 else made.stderr.splitlines()[-1:]
            good = 0
            for mission in MISSIONS if not reasons else []:
                flights = run("fly", vehicle, "--gains", gains, "--mission", mission, "--seeds",
                              SEEDS, "--json")
                verdicts = [flight["verdict"] for flight in json.loads(flights.stdout)]
                good += verdicts.count("pass")
                if flights.returncode != 0:
                    reasons += [f"{mission}: {line}" for line in flights.stderr.splitlines()[-1:]]
            passed += good
            flown += SEEDS * len(MISSIONS)
            complete += not reasons
            print(f"v{seed} ({about}): {good} of {SEEDS * len(MISSIONS)}", flush=True)
            for reason in reasons:
                print(f"    {reason}", flush=True)
    print(f"{passed} of {flown} flights pass; {complete} of {asked.count} vehicles pass all")


if __name__ == "__main__":
    main()
