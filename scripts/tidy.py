#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over source files: tidy.py BUILD FILE...

A file that passed is not looked at again until it, a header that it includes, its flags, the rules
in .clang-tidy or clang-tidy itself change: BUILD/tidy holds an empty file for each that passed.
Exit status 1 if a file did not pass.
"""

import hashlib
import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# The build's flags are GCC's; clang need not know all of them.
EXTRA = ["-extra-arg=-Wno-unknown-warning-option", "-extra-arg=-Wno-ignored-optimization-argument"]


def preprocessed(entry):
    """What the compiler sees of a file, with its comments, for some of them speak to clang-tidy."""
    words = shlex.split(entry["command"])
    output = words.index("-o")
    command = words[:output] + words[output + 2 :] + ["-E", "-P", "-C"]
    return subprocess.run(command, cwd=entry["directory"], capture_output=True, check=True).stdout


def check(entry, build, rules):
    """Whether a file passes; what clang-tidy or the compiler says of it where it does not."""
    try:
        seen = preprocessed(entry)
    except subprocess.CalledProcessError as error:
        return False, error.stderr.decode()
    content = hashlib.sha256(rules + entry["command"].encode() + seen).hexdigest()
    passed = build / "tidy" / content
    if passed.exists():
        return True, ""
    run = subprocess.run(
        ["clang-tidy", "-quiet", "-p", str(build), *EXTRA, entry["file"]],
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode == 0:
        passed.touch()
    return run.returncode == 0, run.stdout


def main():
    build = Path(sys.argv[1])
    (build / "tidy").mkdir(exist_ok=True)
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    entries = {entry["file"]: entry for entry in commands}
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    rules = version + Path(".clang-tidy").read_bytes()
    bad = False
    chosen = []
    for name in sys.argv[2:]:
        entry = entries.get(str(Path(name).resolve()))
        if entry is None:
            print(f"{name}: no command compiles it")
            bad = True
        else:
            chosen.append(entry)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for passed, said in pool.map(lambda entry: check(entry, build, rules), chosen):
            bad = bad or not passed
            print(said, end="", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
