#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that every public header is in one umbrella header or in the list of implementation headers:
check_umbrellas.py SOURCE, or check_umbrellas.py --unused SOURCE

--unused prints the implementation headers that no header for users includes, directly or through others.
Exit status 1 if a check fails.
"""

import re
import sys
from pathlib import Path

# Folder and its umbrella headers. The last one includes all others.
UMBRELLAS = {
    "lib": ["model", "control", "estimation", "simulation", "logs"],
    "linearize": ["linearize"],
    "discretize": ["discretize"],
    "synthesis": ["synthesis"],
    "tuning": ["tuning"],
    "exports": ["exports"],
    "workbench": ["workbench"],
}
EVERYTHING = "quadtune/quadtune.hpp"
LIST = "scripts/implementation_headers.txt"

INCLUDE = re.compile(r'^\s*#\s*include\s+["<](quadtune/[^">]+)[">](.*)$', re.MULTILINE)
problems = []
installed = set()  # implementation headers that the list marks with "+"


def public_headers(source):
    """Header as users include it -> (folder, text)."""
    headers = {}
    for folder in UMBRELLAS:
        root = source / folder / "include"
        for path in root.rglob("*.hpp"):
            headers[str(path.relative_to(root))] = (folder, path.read_text(encoding="utf-8"))
    return headers


def includes(text):
    return [match.group(1) for match in INCLUDE.finditer(text)]


def read_list(source, headers):
    """The implementation headers, each with a reason."""
    listed = {}
    for number, line in enumerate((source / LIST).read_text(encoding="utf-8").splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        header, _, reason = line.partition(" ")
        if header.startswith("+"):
            header = header[1:]
            installed.add(header)
        if header not in headers:
            problems.append(f"{LIST}:{number}: there is no header {header}")
        elif not reason.strip():
            problems.append(f"{LIST}:{number}: the reason why {header} is not for users is missing")
        elif header in listed:
            problems.append(f"{LIST}:{number}: {header} is listed twice")
        listed[header] = reason
    return listed


def check_umbrella(umbrella, folder, headers):
    """What one umbrella includes: headers of its own folder, each with a comment."""
    if umbrella not in headers:
        problems.append(f"{folder}/include/{umbrella} is missing")
        return []
    text = headers[umbrella][1]
    for match in INCLUDE.finditer(text):
        header, rest = match.groups()
        if not re.match(r"\s*// \S", rest):
            problems.append(f"{umbrella}: {header} has no comment on its line")
        if header not in headers:
            problems.append(f"{umbrella}: there is no public header {header}")
        elif headers[header][0] != folder:
            problems.append(f"{umbrella}: {header} belongs to {headers[header][0]}/, not {folder}/")
    return includes(text)


def check_once(headers, umbrellas, listed):
    """Every header is in exactly one place."""
    places = {header: [] for header in headers}
    for umbrella, (_, included) in umbrellas.items():
        for header in included:
            places.setdefault(header, []).append(umbrella)
    for header in listed:
        places.setdefault(header, []).append(LIST)
    for header, found in sorted(places.items()):
        if header in umbrellas or header == EVERYTHING:
            continue
        if not found:
            problems.append(
                f"{headers[header][0]}/include/{header} is in no umbrella header; include it in one, with a "
                f"comment, or list it with a reason in {LIST}"
            )
        elif len(found) > 1:
            problems.append(f"{header} is in {' and '.join(found)}; expected one of them")


def reachable(roots, headers):
    """All headers that the roots include, directly or through others."""
    seen, waiting = set(), list(roots)
    while waiting:
        header = waiting.pop()
        if header in seen or header not in headers:
            continue
        seen.add(header)
        waiting += includes(headers[header][1])
    return seen


def check_sources(source, umbrellas):
    """The libraries include single headers: an umbrella would make them compile more slowly."""
    for folder in UMBRELLAS:
        for path in sorted((source / folder).rglob("*.[ch]pp")):
            name = str(path.relative_to(source / folder))
            if name == "include/" + EVERYTHING:
                continue
            for header in includes(path.read_text(encoding="utf-8")):
                if header in umbrellas or header == EVERYTHING:
                    problems.append(f"{folder}/{name} includes {header}; expected single headers")


def main():
    source = Path(sys.argv[-1])
    headers = public_headers(source)
    listed = read_list(source, headers)
    umbrellas = {}
    for folder, names in UMBRELLAS.items():
        for name in names:
            header = f"quadtune/{name}.hpp"
            umbrellas[header] = (folder, check_umbrella(header, folder, headers))
    if EVERYTHING not in headers:
        problems.append(f"{EVERYTHING} is missing")
    elif sorted(includes(headers[EVERYTHING][1])) != sorted(umbrellas):
        problems.append(f"{EVERYTHING}: expected the umbrella headers, each once, and nothing else")
    check_once(headers, umbrellas, listed)
    check_sources(source, umbrellas)
    for_users = reachable([EVERYTHING], headers)
    for header in sorted(for_users):
        for included in includes(headers[header][1]):
            if included not in headers:
                problems.append(f"{header} is for users and includes {included}, which is not installed")
    for header in sorted(set(listed) & for_users - installed):
        problems.append(f'{LIST}: a header for users includes {header}; mark it with "+"')
    for header in sorted(installed - for_users):
        problems.append(f'{LIST}: no header for users includes {header}; remove its "+"')
    if sys.argv[1] == "--unused":
        print("\n".join(sorted(set(listed) - for_users)))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
