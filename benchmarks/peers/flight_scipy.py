# SPDX-License-Identifier: Apache-2.0
"""The flight of flight_benchmark.cpp by SciPy's solve_ivp.

Reads a vehicle and a flight as JSON from standard input, writes one line: seconds, steps,
evaluations, then the last state. Plain floats in the equations: for 17 numbers they are faster than
NumPy's arrays.
"""

import json
import sys
import time

from scipy.integrate import solve_ivp

flight = json.load(sys.stdin)
g = flight["gravity"]
inverse_mass = 1 / flight["mass"]
Jx, Jy, Jz = flight["inertia"]
rotors = list(zip(flight["x"], flight["y"], flight["spin"], flight["a2"], flight["a1"],
                  flight["d2"], flight["d1"], flight["rotor_inertia"], flight["lag"],
                  flight["speeds"]))
lagging = flight["lagging"]


def loads(x):
    thrust = tx = ty = tz = h = 0.0
    rises = []
    for i, (px, py, spin, a2, a1, d2, d1, inertia, lag, asked) in enumerate(rotors):
        w = x[13 + i] if lagging else asked
        t = (a2 * w + a1) * w
        thrust += t
        tx -= py * t
        ty += px * t
        tz -= spin * (d2 * w + d1) * w
        h += spin * inertia * w
        if lagging:
            rise = (asked - w) / lag
            rises.append(rise)
            tz -= spin * inertia * rise
    return thrust, tx, ty, tz, h, rises


HELD = None if lagging else loads([])


def motion(_, state):
    x = state.tolist()
    qw, qx, qy, qz, u, v, w, p, q, r = x[3:13]
    thrust, tx, ty, tz, h, rises = loads(x) if lagging else HELD
    r00, r01, r02 = 1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy)
    r10, r11, r12 = 2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx)
    r20, r21, r22 = 2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)
    Lx, Ly, Lz = Jx * p, Jy * q, Jz * r + h
    return [
        r00 * u + r01 * v + r02 * w, r10 * u + r11 * v + r12 * w, r20 * u + r21 * v + r22 * w,
        -0.5 * (qx * p + qy * q + qz * r), 0.5 * (qw * p + qy * r - qz * q),
        0.5 * (qw * q + qz * p - qx * r), 0.5 * (qw * r + qx * q - qy * p),
        r20 * g + r * v - q * w, r21 * g + p * w - r * u,
        -thrust * inverse_mass + r22 * g + q * u - p * v,
        (tx - (q * Lz - r * Ly)) / Jx, (ty - (r * Lx - p * Lz)) / Jy, (tz - (p * Ly - q * Lx)) / Jz,
        *rises]


# The least of several times, as for quadtune.
times = []
for _ in range(10):
    start = time.perf_counter()
    result = solve_ivp(motion, (0, flight["duration"]), flight["start"], method="RK45",
                       rtol=flight["tolerance"], atol=flight["tolerance"],
                       max_step=flight["max_step"])
    times.append(time.perf_counter() - start)
print(min(times), len(result.t) - 1, result.nfev, *result.y[:, -1].tolist())
