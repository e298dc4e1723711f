# SPDX-License-Identifier: Apache-2.0
"""Test sources of a Ninja build, each linked alone with only the objects that it needs.

A test program of the build contains many test sources and loads whole libraries, so a change of a
header compiles most of the project before the first test runs. Here each `*_test.cpp` becomes a
program of its own. The objects of the project form a thin archive, from which the linker takes what
this source needs; only these objects are built before it runs.
"""

import re
import shlex
import subprocess
from pathlib import Path

LIBRARY = re.compile(r"\.(a|so)[.\d]*$")


class LinkedTests:
    """The test sources of some programs in a build folder of CMake."""

    def __init__(self, build_folder, source_folder, jobs):
        self.folder = Path(build_folder).resolve()
        self.sources = Path(source_folder).resolve()
        self.jobs = jobs
        self.recipes = {}  # program -> (compiler and its options, libraries outside the project)
        self.objects = {}  # program -> its own objects and those of the project's libraries
        self.needed = {}  # (program, object of a test) -> objects that it was linked with
        self.files_of = {}  # object -> files that it is compiled from

    def ninja(self, *words):
        run = subprocess.run(["ninja", *words], cwd=self.folder, capture_output=True, text=True,
                             check=False)  # fmt: skip
        return run.returncode, run.stdout + run.stderr

    def link_command(self, target):
        """Words of the command that links a target, without what runs before and after it."""
        _, said = self.ninja("-t", "commands", "-s", target)
        command = said.strip().split("\n")[-1]
        parts = [part.strip() for part in command.split(" && ")]
        return shlex.split(next(part for part in parts if part != ":"))

    def inputs(self, target):
        _, said = self.ninja("-t", "query", target)
        said = said.split("\n  outputs:")[0]
        return re.findall(r"^    (?:\| )?([^|\s]\S*)$", said, re.MULTILINE)

    def add_program(self, program):
        """Reads how the build links a program."""
        target = f"bin/{program}"
        words = self.link_command(target)
        options, outside = [words[0]], []
        for before, word in zip(words, words[1:]):
            if word == "-o" or before == "-o" or word.startswith("-Wl,-rpath"):
                continue
            if word.startswith("-l") or (word.startswith("/") and LIBRARY.search(word)):
                outside.append(word)
            elif word.startswith("-"):
                options.append(word)
        objects, libraries = [], [target]
        for library in libraries:  # which grows
            for name in self.inputs(library):
                if name.endswith(".o") and name not in objects:
                    objects.append(name)
                elif LIBRARY.search(name) and not name.startswith("/") and name not in libraries:
                    libraries.append(name)
                    outside += [word for word in self.link_command(name)
                                if word.startswith("/") and LIBRARY.search(word)
                                and word not in outside]  # fmt: skip
        self.recipes[program] = options, outside
        self.objects[program] = objects

    def object_of(self, program, source):
        """The object of a test source, e.g. of tests/lib/model/mixer_test.cpp."""
        found = [name for name in self.objects[program] if self.belongs(name, source)]
        if len(found) != 1:
            raise RuntimeError(
                f"{program} has {len(found)} objects of {source}, expected exactly 1 object")
        return found[0]

    @staticmethod
    def belongs(object_name, source):
        """Whether, e.g., tests/lib/CMakeFiles/test_lib.dir/model/mixer_test.cpp.o is of a source."""
        folder, _, rest = object_name.partition("/CMakeFiles/")
        return f"{folder}/{rest.partition('.dir/')[2]}" == f"{source}.o"

    def objects_of_project(self):
        """Objects of all programs that are not test sources: those that a test may need."""
        return {name for objects in self.objects.values() for name in objects
                if not name.endswith("_test.cpp.o")}  # fmt: skip

    def build(self, objects):
        """What the compiler says where it fails; nothing where all objects are built.
        @raise RuntimeError  if the build ends without a word of the compiler: somebody ended it"""
        status, said = self.ninja("-j", str(self.jobs), *sorted(objects))
        if status and "error:" not in said:
            raise RuntimeError(f"the build ended with {status}: {said.strip()[-500:]}")
        return said if status else ""

    def program_of(self, test):
        return self.folder / "alone" / test[0] / Path(test[1]).name.removesuffix(".cpp.o")

    def build_test(self, test):
        """Builds and links one test source. What the compiler or the linker says where it fails."""
        program, own = test
        target = self.program_of(test)
        target.parent.mkdir(parents=True, exist_ok=True)
        needed = self.needed.setdefault(test, {own})
        options, outside = self.recipes[program]
        archive = self.folder / f"{program}.a"  # its members have paths from where it lies
        others = [name for name in self.objects[program] if not name.endswith("_test.cpp.o")]
        while True:
            said = self.build(needed)
            if said:
                return said
            archive.unlink(missing_ok=True)
            present = [name for name in others if (self.folder / name).exists()]
            for words in (
                ["ar", "rcsT", archive.name, *present],
                [*options, "-Wl,--trace", own, archive.name, *outside, "-o", str(target)],
            ):
                run = subprocess.run(words, cwd=self.folder, capture_output=True, text=True,
                                     check=False)  # fmt: skip
                if run.returncode:
                    return f"error: {run.stderr.strip()[-2000:]}"
            # Traced as ARCHIVE(OBJECT) or as OBJECT, each with a path.
            traced = re.split(r"[()\s]+", run.stdout)
            used = {name for name in others if any(word.endswith(name) for word in traced)}
            if used <= needed:
                return ""
            needed |= used

    def read_dependencies(self):
        """Reads which files each object is compiled from; call it when the objects are built."""
        _, said = self.ninja("-t", "deps")
        for block in said.split("\n\n"):
            lines = block.strip().split("\n")
            name = lines[0].partition(":")[0]
            self.files_of[name] = {line.strip() for line in lines[1:]}

    def dependants(self, source):
        """Objects that are compiled from a file, directly or by including it."""
        path = self.sources / source
        return {name for name, files in self.files_of.items()
                if any(file.endswith(source) and (self.folder / file).resolve() == path
                       for file in files)}  # fmt: skip

    def cost_s(self, objects):
        """A rough estimate of the time to compile objects, by their size."""
        paths = [self.folder / name for name in objects]
        return sum(path.stat().st_size for path in paths if path.exists()) / 1e5
