#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs one file of tests with pytest, or is skipped: run_tests.py FILE."""

import importlib.util
import sys
from pathlib import Path

NEEDED = {"numpy": "python3-numpy", "pytest": "python3-pytest"}
NEEDED_BY = {"test_notebook.py": {"matplotlib": "python3-matplotlib"}}


def main(name):
    needed = NEEDED | NEEDED_BY.get(name, {})
    absent = [package for module, package in needed.items()
              if importlib.util.find_spec(module) is None]
    if absent:
        print("skipped: not installed here: Debian's", ", ".join(absent))
        return 77
    sys.dont_write_bytecode = True
    import pytest
    return pytest.main(["-q", "-p", "no:cacheprovider", str(Path(__file__).parent / name)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
