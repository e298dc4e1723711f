#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes the numerical core and sees whether a test notices: mutate.py [HOW MANY] [SEED] [FOLDER]

Each mutant is one small change of one line: an operator, a comparison, a constant, a sign, a returned
value. It is made in a copy of the sources under build/mutate. Of the test sources of its folder,
each that uses the changed file is built and run alone: first the one named like the file, then
those that take less time. There is one copy per processor, and as many mutants are judged at once. A
failing test or one without an end kills a mutant; one that does not compile is counted apart, and
another takes its place. What survives stands in build/mutate/report.md. A survivor that behaves as
the original does is explained in scripts/mutants.txt: file, line, changed line and reason,
separated by tabs.

FOLDER limits the choice, e.g. discretize/ or synthesis/riccati/. `mutate.py again` judges the
survivors of the last report anew, after tests were added. Exit status 1 if a mutant survives without
an explanation, 2 if the unchanged sources do not pass.
"""

import itertools
import os
import queue
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path

from linked_tests import LinkedTests

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "mutate"
REPORT = WORK / "report.md"
EXPLAINED = ROOT / "scripts" / "mutants.txt"

# Folder of sources -> the tests that run, by the beginning of their path.
TESTS = {
    "linearize/": ["tests/linearize/"],
    "discretize/": ["tests/discretize/"],
    "synthesis/cascade/": ["tests/synthesis/cascade/"],
    "synthesis/certify/": ["tests/synthesis/certify/"],
    "synthesis/flown/": ["tests/synthesis/flown/", "tests/synthesis/lqr/"],
    "synthesis/kalman/": ["tests/synthesis/kalman/"],
    "synthesis/lqr/": ["tests/synthesis/lqr/"],
    "synthesis/lyapunov/": ["tests/synthesis/lyapunov/"],
    # The parts of an uncertain loop are tested with the proof of its stability.
    "synthesis/margins/": ["tests/synthesis/margins/", "tests/synthesis/certify/"],
    "synthesis/pid/": ["tests/synthesis/pid/", "tests/synthesis/cascade/"],
    "synthesis/riccati/": ["tests/synthesis/riccati/", "tests/synthesis/lqr/"],
    "lib/model/": [
        "tests/lib/model/",
        "tests/lib/simulation/motor_",
        "tests/lib/simulation/sensor_",
        "tests/lib/simulation/rotor_",
        "tests/lib/estimation/uquad_filter_test.cpp",  # the Jacobian of the equations of motion
    ],
    "lib/control/": [
        "tests/lib/control/",
        "tests/lib/simulation/",
        "tests/lib/files/design_test.cpp",  # the reader of cascades
    ],
}
# Public headers with the physics and the laws; those of the other folders declare only.
TESTS["lib/include/quadtune/model/"] = TESTS["lib/model/"]
TESTS["lib/include/quadtune/control/"] = TESTS["lib/control/"]

SHORTEST_LIMIT_S = 30  # for tests that take less than a few seconds
LIMIT_FACTOR = 5  # a mutant may take so many times as long as the original
LIMIT_MEMORY = 8 << 30  # bytes of address space

TOKEN = re.compile(
    r"""
      (?P<comment>//[^\n]*|/\*.*?\*/)
    | (?P<raw>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)")
    | (?P<string>"(?:\\.|[^"\\\n])*")
    | (?P<directive>^[ \t]*\#(?:\\\n|[^\n])*)
    | (?P<number>(?:0[xX][0-9a-fA-F']+|(?:\d[\d']*(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)[uUlLfF]*)
    | (?P<char>'(?:\\.|[^'\\\n])+')
    | (?P<word>[A-Za-z_]\w*)
    | (?P<operator><<=|>>=|<=>|->\*?|\+\+|--|&&|\|\||[-+*/<>=!]=|<<|>>|::|[-+*/<>])
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
# clang-format puts white space around an operator of two operands and none beside the star of a
# pointer or the bracket of a template.
BINARY = {
    "+": "-", "-": "+", "*": "/", "/": "*",
    "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
    "<": "<=", "<=": "<", ">": ">=", ">=": ">",
    "==": "!=", "!=": "==", "&&": "||", "||": "&&",
}  # fmt: skip
CONSTANTS = {
    "0": "1", "1": "0", "2": "3", "3": "4", "4": "5",
    "0.0": "1.0", "1.0": "0.0", "2.0": "3.0", "0.25": "0.3", "0.5": "0.6", "1.5": "1.6",
}  # fmt: skip
WORDS = {"true": "false", "false": "true"}
RETURNED = re.compile(r"^(\s*(?:if \(.*\) |else )?return )([\w(-][^{};\"]*);\s*(?://.*)?$")
TRUTH = re.compile(r" [<>=!]=? | && | \|\| |^!|\.(?:all|any|empty|allFinite)\(\)$|\bisfinite\(")
# The line that opens a function or a lambda.
OPENING = re.compile(r"^(?!\s*(?:\} )?(?:if|else|for|while|switch|do|try|namespace)\b).*\{$")
# One that returns a number, a vector or a matrix.
NUMBERS = re.compile(
    r"^\s*(?:(?:\[\[nodiscard\]\]|static|inline|constexpr) )*"
    r"(?:double|float|int|long|T|(?:Eigen::)?(?:Index|(?:Vector|Matrix|Array|RowVector)\w*(?:<.*?>)?)"
    r"|std::complex<\w+>) [\w:]+\("
)
LEFT_ALONE = re.compile(r"\b\w*assert\w*\s*\(|\btemplate\s*<|^\s*using\b|///<")
PROGRAM = re.compile(r"^ *quadtune_test\((\w+)((?:[^()]|\$\{\w+\})*)\)", re.MULTILINE)


class Mutant:
    """One change: the text from `start` to `end` of a file becomes `after`."""

    def __init__(self, name, text, start, end, after):
        self.name, self.start, self.end, self.after = name, start, end, after
        self.line = text.count("\n", 0, start) + 1
        begin = text.rfind("\n", 0, start) + 1
        stop = text.find("\n", end)
        stop = len(text) if stop < 0 else stop
        self.was = text[begin:stop].strip()
        self.now = (text[begin:start] + after + text[end:stop]).strip()

    def __str__(self):
        return f"{self.name}:{self.line}: {self.was}  ->  {self.now}"


def sign_of(expression, lines_before):
    """What to put before a returned value: "!", "-", or nothing where its type is not known to have
    a negative. The minus of a truth value would be the same truth value."""
    if "?" not in expression and TRUTH.search(expression):
        return "!"
    opening = next((line for line in reversed(lines_before) if OPENING.match(line)), "")
    if re.search(r"\bbool [\w:]+\(|-> bool \{$", opening):
        return "!"
    return "-" if NUMBERS.match(opening) else ""


def mutants_of(name, text):
    """All mutants of a source file."""
    lines = text.split("\n")
    found = []

    def add(start, end, after):
        if not LEFT_ALONE.search(lines[text.count("\n", 0, start)]):
            found.append(Mutant(name, text, start, end, after))

    for token in TOKEN.finditer(text):
        start, end, what = token.start(), token.end(), token.group()
        spaced = text[start - 1 : start].isspace() and text[end : end + 1].isspace()
        if token.lastgroup == "operator":
            if what in BINARY and spaced:
                add(start, end, BINARY[what])
            elif what == "-" and re.match(r"[\w(.]", text[end : end + 1]):
                add(start, end, "")  # a sign
        elif token.lastgroup == "number" and what in CONSTANTS:
            add(start, end, CONSTANTS[what])
        elif token.lastgroup == "word" and what in WORDS:
            add(start, end, WORDS[what])
    at = 0
    for number, line in enumerate(lines):
        returned = RETURNED.match(line)
        if returned and returned[2] not in WORDS:
            sign = sign_of(returned[2], lines[:number])
            if sign:
                add(at + returned.start(2), at + returned.end(2), f"{sign}({returned[2]})")
        at += len(line) + 1
    return found


def room_of(name):
    return next((room for room in TESTS if name.startswith(room)), None)


def project_files():
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"],
        cwd=ROOT, capture_output=True, check=True,
    ).stdout.decode()  # fmt: skip
    return sorted(name for name in set(listed.split("\0")) if name and (ROOT / name).is_file())


class Copy:
    """A copy of the sources, in which one mutant at a time is made, and its build."""

    def __init__(self, number):
        self.tree = WORK / str(number) / "tree"
        self.build_folder = WORK / str(number) / "build"

    def update(self, names):
        """Makes the tree what the checkout is; what did not change keeps its time of change."""
        for name in names:
            source, target = ROOT / name, self.tree / name
            if not target.exists() or target.read_bytes() != source.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                target.unlink(missing_ok=True)
                shutil.copyfile(source, target)
            shutil.copymode(source, target)
        known = set(names)
        for path in self.tree.rglob("*"):
            if path.is_file() and str(path.relative_to(self.tree)) not in known:
                path.unlink()
        subprocess.run(
            ["cmake", "--preset", "mutate", "-B", str(self.build_folder)],
            cwd=self.tree, stdout=subprocess.DEVNULL, check=True,
        )  # fmt: skip
        self.linked = LinkedTests(self.build_folder, self.tree, os.cpu_count())


def test_programs():
    """{program: its sources}, without the programs that need a peer."""
    programs = {}
    for lists in sorted((ROOT / "tests").glob("**/CMakeLists.txt")):
        for call in PROGRAM.finditer(lists.read_text(encoding="utf-8")):
            if "LABELS" in call[2]:
                continue
            sources = [lists.parent / word for word in call[2].split() if word.endswith("_test.cpp")]
            programs[f"test_{call[1]}"] = [str(path.relative_to(ROOT)) for path in sources]
    return programs


def sources_of(room):
    """[(program, test source)] of a folder."""
    found = [(program, name) for program, sources in test_programs().items() for name in sources
             if name.startswith(tuple(TESTS[room]))]  # fmt: skip
    if not found:
        sys.exit(f"mutate: no test program has tests in {' '.join(TESTS[room])}")
    return sorted(found)


def run_test(copy, test, limit_s):
    """How a test source ends: "passed", "failed" or "no end", with the first failing test."""
    program = copy.linked.program_of(test)
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "output"
        with output.open("wb") as stream:
            run = subprocess.Popen(
                [str(program), "--gtest_brief=1", "--gtest_fail_fast"],
                cwd=folder, stdout=stream, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"}, start_new_session=True,
                preexec_fn=lambda: resource.setrlimit(
                    resource.RLIMIT_AS, (LIMIT_MEMORY, LIMIT_MEMORY)),
            )  # fmt: skip
            try:
                status = run.wait(limit_s)
            except subprocess.TimeoutExpired:
                return "no end", ""
            finally:
                try:
                    os.killpg(run.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                run.wait()
        if status == 0:
            return "passed", ""
        said = output.read_text(encoding="utf-8", errors="replace")
        failed = re.search(r"\[  FAILED  \] (\S+)", said)
        return "failed", failed[1] if failed else f"{program.name} ended with {status}"


class Tests:
    """The tests of the folders to change, after they have passed with the unchanged sources."""

    def __init__(self, rooms, copies):
        self.of_room = {}  # folder -> [test]
        self.took_s = {}  # test -> duration
        self.first = copies[0].linked  # knows what uses what; this is equal in all copies
        programs = {program for room in rooms for program, _ in sources_of(room)}
        for copy in copies:  # all but the first from ccache
            print(f"mutate: building {copy.build_folder}", flush=True)
            for program in sorted(programs):
                copy.linked.add_program(program)
            for room in rooms:
                self.of_room[room] = [(program, copy.linked.object_of(program, name))
                                      for program, name in sources_of(room)]  # fmt: skip
            tests = sorted({test for room in rooms for test in self.of_room[room]})
            copy.linked.needed = self.first.needed
            self.require(copy.linked.build(
                {own for _, own in tests} | copy.linked.objects_of_project()))  # fmt: skip
            for test in tests:
                self.require(copy.linked.build_test(test))
        self.first.read_dependencies()
        for test in tests:
            start = time.monotonic()
            outcome, why = run_test(copies[0], test, 3600)
            if outcome != "passed":
                print(f"mutate: {test[1]} does not pass with the unchanged sources: {why}")
                sys.exit(2)
            self.took_s[test] = time.monotonic() - start

    @staticmethod
    def require(said):
        if said:
            print(said)
            print("mutate: the unchanged sources do not build")
            sys.exit(2)

    def limit_s(self, test):
        return max(SHORTEST_LIMIT_S, LIMIT_FACTOR * self.took_s[test])

    def that_use(self, name):
        """The tests of its folder that a change of a file can affect, in the order to try them."""
        changed = self.first.dependants(name)
        stem = Path(name).stem

        def key(test):
            tested = Path(test[1]).name.removesuffix("_test.cpp.o")
            alike = stem.startswith(tested) or tested.startswith(stem)
            compiled = self.first.needed[test] & changed
            return (0 if stem == tested else 1 if alike else 2,
                    self.took_s[test] + self.first.cost_s(compiled))  # fmt: skip

        return sorted((test for test in self.of_room[room_of(name)]
                       if self.first.needed[test] & changed), key=key)  # fmt: skip


def judge(mutant, tests, copy):
    """"invalid", "survived", or by what it was killed. The tree is as before afterwards."""
    path = copy.tree / mutant.name
    text = path.read_text(encoding="utf-8")
    try:
        path.write_text(text[: mutant.start] + mutant.after + text[mutant.end :], encoding="utf-8")
        for test in tests.that_use(mutant.name):
            if copy.linked.build_test(test):
                return "invalid"
            outcome, why = run_test(copy, test, tests.limit_s(test))
            if outcome != "passed":
                return why or f"{Path(test[1]).stem} did not end"
        return "survived"
    finally:
        path.write_text(text, encoding="utf-8")


def judge_all(candidates, how_many, tests, copies):
    """Yields (mutant, fate, duration in s) of the first candidates of which `how_many` compile, as
    they end."""
    free = queue.SimpleQueue()
    for copy in copies:
        free.put(copy)

    def judge_one(mutant):
        copy = free.get()
        try:
            start = time.monotonic()
            fate = judge(mutant, tests, copy)
            return mutant, fate, time.monotonic() - start
        finally:
            free.put(copy)

    rest = iter(candidates)
    with ThreadPoolExecutor(len(copies)) as pool:
        running = {pool.submit(judge_one, mutant) for mutant in itertools.islice(rest, how_many)}
        try:
            while running:
                ended, running = wait(running, return_when=FIRST_COMPLETED)
                for one in ended:
                    mutant, fate, took_s = one.result()
                    if fate == "invalid":
                        running |= {pool.submit(judge_one, m) for m in itertools.islice(rest, 1)}
                    yield mutant, fate, took_s
        finally:
            pool.shutdown(cancel_futures=True)


def explanations():
    """(file, line, changed line) -> reason."""
    reasons = {}
    if EXPLAINED.exists():
        for number, line in enumerate(EXPLAINED.read_text(encoding="utf-8").splitlines(), 1):
            if not line.strip() or line.startswith("#"):
                continue
            fields = [field.strip() for field in line.split("\t")]
            if len(fields) != 4:
                sys.exit(f"{EXPLAINED}:{number}: {len(fields)} fields between tabs, expected 4")
            reasons[tuple(fields[:3])] = fields[3]
    return reasons


def write_report(seed, killed, survivors, explained, invalid):
    judged = len(killed) + len(survivors) + len(explained)
    text = [
        "# Mutants", "",
        f"Seed {seed}: {judged} mutants, {len(killed)} killed, {len(explained)} survived with an "
        f"explanation, {len(survivors)} without. Besides, {invalid} did not compile.",
    ]  # fmt: skip
    if survivors:
        text += ["", "## Survivors"]
        for mutant in survivors:
            text += ["", f"{mutant.name}:{mutant.line}", "", f"    {mutant.was}", f"->  {mutant.now}"]
    if explained:
        text += ["", "## Survivors that are explained"]
        for mutant, reason in explained:
            text += ["", f"{mutant.name}:{mutant.line}: {reason}", ""]
            text += [f"    {mutant.was}", f"->  {mutant.now}"]
    if killed:
        text += ["", "## Killed", ""]
        text += [f"- {mutant.name}:{mutant.line} by {by}" for mutant, by in killed]
    REPORT.write_text("\n".join(text) + "\n", encoding="utf-8")


def last_survivors():
    """(seed, {(file, line, changed line)}) of the report."""
    if not REPORT.exists():
        sys.exit(f"mutate: {REPORT.relative_to(ROOT)} does not exist; run ./dev mutate first")
    text = REPORT.read_text(encoding="utf-8")
    text = text.split("\n## Survivors that are explained")[0].split("\n## Killed")[0]
    found = re.findall(r"^(\S+):\d+\n\n    (.*)\n->  (.*)$", text, re.MULTILINE)
    return int(re.search(r"Seed (\d+)", text)[1]), set(found)


def main(how_many=100, seed=1, folder=""):
    names = project_files()
    candidates = []
    for name in names:
        if name.endswith((".cpp", ".hpp")) and room_of(name) and name.startswith(folder):
            candidates += mutants_of(name, (ROOT / name).read_text(encoding="utf-8"))
    if not candidates:
        sys.exit(f"mutate: nothing to change in '{folder}', expected one of {' '.join(TESTS)}")
    if how_many == "again":
        seed, wanted = last_survivors()
        candidates = [one for one in candidates if (one.name, one.was, one.now) in wanted]
        how_many = len(candidates)
        if not candidates:
            print("mutate: the last report has no survivor that the sources still allow")
            return 0
    how_many, seed = int(how_many), int(seed)
    random.Random(seed).shuffle(candidates)
    rooms = sorted({room_of(mutant.name) for mutant in candidates[: 3 * how_many]})

    # Without ccache each copy would compile everything.
    copies = [Copy(i) for i in range(os.cpu_count() if shutil.which("ccache") else 1)]
    for copy in copies:
        copy.tree.mkdir(parents=True, exist_ok=True)
        copy.update(names)
    start = time.monotonic()
    tests = Tests(rooms, copies)
    built = time.monotonic()

    reasons = explanations()
    killed, survivors, explained, invalid = [], [], [], 0
    for mutant, fate, took_s in judge_all(candidates[: 3 * how_many], how_many, tests, copies):
        reason = reasons.get((mutant.name, mutant.was, mutant.now))
        if fate == "invalid":
            invalid += 1
            continue
        if fate != "survived":
            killed.append((mutant, fate))
            print(f"{took_s:4.0f} s, killed by {fate}: {mutant}", flush=True)
        elif reason:
            explained.append((mutant, reason))
            print(f"{took_s:4.0f} s, survived, which is explained: {mutant}", flush=True)
        else:
            survivors.append(mutant)
            print(f"{took_s:4.0f} s, SURVIVED: {mutant}", flush=True)
        write_report(seed, killed, survivors, explained, invalid)
    write_report(seed, killed, survivors, explained, invalid)
    print(REPORT.read_text(encoding="utf-8").split("\n")[2])
    print(f"mutate: {built - start:.0f} s for the unchanged sources, "
          f"{time.monotonic() - built:.0f} s for the mutants")
    print(f"mutate: {REPORT.relative_to(ROOT)} has the survivors")
    return 1 if survivors else 0


if __name__ == "__main__":
    if len(sys.argv) > 4 or "-h" in sys.argv or "--help" in sys.argv:
        sys.exit(__doc__)
    if sys.argv[1:] != ["again"] and not all(word.isdecimal() for word in sys.argv[1:3]):
        sys.exit(f"mutate: expected two numbers and a folder, or again\n{__doc__}")
    try:
        sys.exit(main(*sys.argv[1:]))
    except RuntimeError as stopped:
        sys.exit(f"mutate: {stopped}")
