# SPDX-License-Identifier: Apache-2.0
"""The type stubs and the docstrings."""

import ast
import inspect
import subprocess
import sys

import pytest
from program import ROOT

import quadtune

STUBS = ROOT / "python" / "quadtune" / "__init__.pyi"
ASKED = ["vehicles", "linearize", "lqr", "lqg", "kalman", "discretize", "margins", "pid", "design", "place", "analyze",
         "schedule", "load_schedule", "tune_lqr",
         "fly", "campaign", "tune_kalman", "tune_pid", "certify", "export", "verify"]


def test_stubs_are_those_of_the_module():
    """make_stubs.py writes them."""
    written = subprocess.run([sys.executable, ROOT / "python" / "make_stubs.py"], check=True,
                             capture_output=True, text=True).stdout
    assert written == STUBS.read_text()


def test_stubs_are_python_and_have_every_public_name():
    text = STUBS.read_text()
    names = {node.name for node in ast.parse(text).body if hasattr(node, "name")}
    assert names == set(quadtune.__all__)
    assert names.issuperset(ASKED)
    for foreign in ("::", "arg0", "_quadtune", "object:", "-> object"):
        assert foreign not in text


@pytest.mark.parametrize("name", quadtune.__all__)
def test_every_public_name_has_a_docstring(name):
    member = getattr(quadtune, name)
    assert member.__doc__ and member.__doc__.strip()
    if inspect.isclass(member):
        assert member.__module__ == "quadtune"
        for attribute, value in vars(member).items():
            if not attribute.startswith("_"):
                assert value.__doc__ and len(value.__doc__.strip().split("\n")[-1]) > 3, attribute
    else:
        # Beyond the signature that pybind11 writes.
        prose = [line for line in member.__doc__.split("\n")[1:] if line.strip()]
        assert prose, name


def test_the_version_is_that_of_the_program():
    import os
    printed = subprocess.run([os.environ["QUADTUNE"], "--version"], check=True,
                             capture_output=True, text=True).stdout
    assert quadtune.__version__ in printed
