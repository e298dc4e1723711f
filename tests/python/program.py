# SPDX-License-Identifier: Apache-2.0
"""The program beside the module: what it prints, and comparisons that refuse NaN."""

import json
import math
import os
import subprocess
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]


def printed(*args):
    """What `quadtune ARGS --json` prints, whatever its answer."""
    command = [os.environ["QUADTUNE"], *map(str, args), "--json", "--quiet"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=1200)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def answer(*args):
    return json.loads(printed(*args))


def assert_prints_as(result, *args):
    """The result's JSON has the bytes that the program prints."""
    assert result.to_json() + "\n" == printed(*args)


def assert_same(array, numbers):
    """Equal to the last bit, all finite."""
    expected = np.array(numbers, dtype=float)
    assert np.isfinite(expected).all() and expected.size > 0
    assert np.shape(array) == expected.shape
    assert np.array_equal(np.asarray(array), expected)


def assert_same_poles(poles, pairs):
    """Complex numbers against [real, imaginary]."""
    assert_same(np.column_stack([poles.real, poles.imag]), pairs)


def decibels(gain):
    return 20 * math.log10(gain)


def without(result, *keys):
    """A JSON object without what differs from run to run, at any depth."""
    if isinstance(result, dict):
        return {key: without(value, *keys) for key, value in result.items() if key not in keys}
    if isinstance(result, list):
        return [without(value, *keys) for value in result]
    return result
