#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the links and tables of Markdown files: check_links.py FILE...

Relative links must lead to a file or folder of the project, and their #anchors to a heading there.
Links to the web are not followed. Each row of a table must be one line. Prints one line per
problem; exit status 1 if there is one.
"""

import os
import re
import sys
from pathlib import Path

LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
REFERENCE = re.compile(r"^\s{0,3}\[[^\]]+\]:\s*<?(\S+?)>?(?:\s|$)")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*\s*$")
WEB = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def prose_lines(path):
    """Numbered lines outside of code fences."""
    fence = None
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        opened = re.match(r"\s*(```+|~~~+)", line)
        if opened and fence is None:
            fence = opened.group(1)
        elif opened and opened.group(1).startswith(fence):
            fence = None
        elif fence is None:
            yield number, line


def slug(heading, found):
    """The anchor that GitHub and GitLab make of a heading, added to those found before."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    base = anchor = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
    copies = 0
    while anchor in found:
        copies += 1
        anchor = f"{base}-{copies}"
    found.add(anchor)
    return anchor


def anchors(path):
    """The anchors of a file's headings, and those written as HTML."""
    found = set()
    for _, line in prose_lines(path):
        found.update(re.findall(r"<a\s+(?:id|name)=\"([^\"]+)\"", line))
        heading = HEADING.match(line)
        if heading:
            slug(heading.group(1), found)
    return found


def problem(source, target):
    """Why the link does not lead anywhere, or None."""
    if WEB.match(target):
        return None
    name, _, anchor = target.partition("#")
    path = Path(os.path.normpath(source.parent / name)) if name else source
    if not path.exists():
        return "no such file"
    if path.is_absolute() or path.parts[:1] == ("..",):
        return "leads out of the project"
    if anchor and path.suffix == ".md" and anchor not in anchors(path):
        return "no such heading"
    return None


def broken_rows(path):
    """Numbers of the lines within tables that are not a whole row."""
    in_table = False
    for number, line in prose_lines(path):
        if re.match(r"\s*\|[-:| ]+\|\s*$", line):
            in_table = True
        elif not line.strip():
            in_table = False
        elif in_table and not re.match(r"\s*\|.*\|\s*$", line):
            yield number


def main(files):
    broken = 0
    for name in files:
        source = Path(name)
        for number in broken_rows(source):
            print(f"{source}:{number}: this line of a table is not a whole row")
            broken += 1
        for number, line in prose_lines(source):
            prose = re.sub(r"`[^`]*`", "", line)
            targets = LINK.findall(prose) + REFERENCE.findall(prose)
            for target in targets:
                why = problem(source, target)
                if why:
                    print(f"{source}:{number}: link to {target}: {why}")
                    broken += 1
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
