#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over source files: tidy.py BUILD FILE...

Files that the build compiles together (cmake/Batches.cmake) are also checked together, because most
of the time goes into headers that they share. clang's analyzer examines the functions of the main
file only, so the batch is not a file of #include lines here: BUILD/tidy/batches holds the files one
after another, and the positions in what clang-tidy prints are those in the files themselves.

What passed is not checked again until a file, a header that it includes, its flags, the rules in
.clang-tidy or clang-tidy itself change: BUILD/tidy holds an empty file for each that passed.
Exit status 1 if a file did not pass.
"""

import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# The build's flags are GCC's; clang need not know all of them.
FOREIGN_FLAGS = [
    "-Wno-unknown-warning-option",
    "-Wno-ignored-optimization-argument",
    "-Wno-unused-command-line-argument",
]


class Unit:
    """What is checked at once: one source file, or those of a batch."""

    def __init__(self, entry, build):
        words = shlex.split(entry["command"])
        output = words.index("-o")
        self.folder = entry["directory"]
        self.main = Path(entry["file"])
        # Without the compiler, -o FILE, and -c FILE at the end.
        self.flags = words[1:output] + words[output + 2 : -2]
        self.sources = [self.main]
        self.lines = []  # of each line of the main file, where a batch has it from
        if self.main.parent.name.endswith("_batches"):
            self.join(build / "tidy" / "batches")

    def join(self, folder):
        included = re.findall(r'^#include "(.+)"$', self.main.read_text(encoding="utf-8"), re.M)
        roots = [Path(flag[2:]) for flag in self.flags if flag.startswith("-I")]
        self.sources = [next(r / name for r in roots if (r / name).exists()) for name in included]
        text = []
        for source in self.sources:
            content = source.read_text(encoding="utf-8").splitlines()
            self.lines += [(source, number + 1) for number in range(len(content))]
            text += content
        for parent in dict.fromkeys(source.parent for source in self.sources):
            self.flags += ["-iquote", str(parent)]
        folder.mkdir(parents=True, exist_ok=True)
        self.main = folder / f"{self.main.parent.name}_{self.main.name}"
        joined = "\n".join(text) + "\n"
        if not self.main.exists() or self.main.read_text(encoding="utf-8") != joined:
            self.main.write_text(joined, encoding="utf-8")

    def in_sources(self, said):
        """What clang-tidy prints, with the positions in the files that were joined."""
        if not self.lines:
            return said

        def position(match):
            source, number = self.lines[int(match[1]) - 1]
            return f"{source}:{number}:"

        return re.sub(rf"{re.escape(str(self.main))}:(\d+):", position, said)

    def preprocessed(self):
        """What the compiler sees, with its comments, for some of them speak to clang-tidy."""
        command = ["c++", *self.flags, "-E", "-P", "-C", str(self.main)]
        return subprocess.run(command, cwd=self.folder, capture_output=True, check=True).stdout

    def check(self, passed_before, rules):
        """Whether it passes, and what clang-tidy or the compiler says of it where it does not."""
        try:
            seen = self.preprocessed()
        except subprocess.CalledProcessError as error:
            return False, self.in_sources(error.stderr.decode())
        content = hashlib.sha256(rules + shlex.join(self.flags).encode() + seen).hexdigest()
        passed = passed_before / content
        if passed.exists():
            return True, ""
        flags = [flag for flag in self.flags if not flag.startswith("--param=")]
        run = subprocess.run(
            ["clang-tidy", "-quiet", "--config-file=.clang-tidy", str(self.main)]
            + ["--", *flags, *FOREIGN_FLAGS],
            capture_output=True,
            text=True,
            check=False,
        )
        if run.returncode == 0:
            passed.touch()
        return run.returncode == 0, self.in_sources(run.stdout)


def units_of(names, build):
    """The units with these files, and the files that are in none."""
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    units = {}
    for entry in {entry["file"]: entry for entry in commands}.values():
        unit = Unit(entry, build)
        for source in unit.sources:
            units[source.resolve()] = unit
    paths = {name: Path(name).resolve() for name in names}
    missing = [name for name, path in paths.items() if path not in units]
    return list(dict.fromkeys(units[path] for path in paths.values() if path in units)), missing


def main():
    build = Path(sys.argv[1]).resolve()
    (build / "tidy").mkdir(exist_ok=True)
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    rules = version + Path(".clang-tidy").read_bytes()
    units, missing = units_of(sys.argv[2:], build)
    for name in missing:
        print(f"{name}: no command compiles it")
    bad = bool(missing)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for passed, said in pool.map(lambda unit: unit.check(build / "tidy", rules), units):
            bad = bad or not passed
            print(said, end="", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
