#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prepares pages for Doxygen, whose Markdown differs from that of web sites.

doxygen_page.py FILE.md prints a page of docs/ or examples/ with an id for each heading and with links to
pages, examples and headers of the reference; links to other files become their text. The numbers of the
lines do not change. The pages are those of INPUT in scripts/Doxyfile.

doxygen_page.py --examples FOLDER prints what the namespace is, and a page for each program of the folder.
Runs in the root of the sources.
"""

import itertools
import os
import re
import sys
from pathlib import Path

import check_links

LINK = re.compile(r"(?<!!)\[((?:[^\]\[`]|`[^`]*`)*)\]\(([^)\s]+)\)")
CODE = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.DOTALL)
HEADING = re.compile(r"^(#{1,6}) +(.*?) *#*$")
PAGES = re.compile(r"^(docs/(theory/)?[\w-]+|examples/README)\.md$")
PROGRAM = re.compile(r"^examples/(\w+)\.cpp$")
HEADER = re.compile(r"^\w+/include/(quadtune/.*\.hpp)$")


def headings(path):
    """Numbers of the lines with headings, and their ids. The title has that of the page."""
    found = set()
    for number, line in check_links.prose_lines(Path(path)):
        heading = HEADING.match(line)
        if heading:
            title = not found
            slug = check_links.slug(heading.group(2), found)
            yield number, slug, re.sub(r"\W", "_", path if title else f"{path}__{slug}")


def is_installed(header):
    """Whether the header is in the reference."""
    lines = Path("scripts/implementation_headers.txt").read_text(encoding="utf-8").splitlines()
    return not any(line.split(" ")[0] == header for line in lines)


def destination(page, target):
    """The target of a link as Doxygen needs it; None if it is not part of the reference."""
    if check_links.WEB.match(target):
        return target
    name, _, anchor = target.partition("#")
    path = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
    if PAGES.match(path):
        ids = {slug: name for _, slug, name in headings(path)}
        return f"@ref {ids[anchor] if anchor else next(iter(ids.values()))}"
    if PROGRAM.match(path):
        return f"{PROGRAM.match(path).group(1)}_8cpp-example.html"
    if HEADER.match(path) and is_installed(HEADER.match(path).group(1)):
        return f"@ref {HEADER.match(path).group(1)}"
    return None


def link(page, match):
    text, target = match.groups()
    to = destination(page, target)
    if to and to.startswith("@ref"):
        text = text.replace("`", "")  # would be printed
    if not to:
        return text
    breaks = text.count("\n")  # which Doxygen does not accept in a link
    return "\n" * breaks + f"[{' '.join(text.split())}]({to})"


def code(span):
    """Code in double backticks if it contains ', which ends Doxygen's single ones."""
    return f"`{span}`" if "'" in span and not span.startswith("``") else span


def page(name):
    prose = dict(check_links.prose_lines(Path(name)))
    ids = {number: identifier for number, _, identifier in headings(name)}
    lines = Path(name).read_text(encoding="utf-8").splitlines()
    for is_prose, group in itertools.groupby(enumerate(lines, 1), lambda line: line[0] in prose):
        numbers, texts = zip(*group)
        text = "\n".join(texts)
        if is_prose:  # a link may be on two lines
            text = LINK.sub(lambda match: link(name, match), text)
            text = CODE.sub(lambda match: code(match.group(0)), text)
        for number, line in zip(numbers, text.split("\n")):
            yield f"{line} {{#{ids[number]}}}" if number in ids else line


def examples(folder):
    yield "/** @namespace quadtune"
    yield "Everything that the installed headers declare. */"
    for program in sorted(Path(folder).glob("*.cpp")):
        comment = []
        for line in program.read_text(encoding="utf-8").splitlines()[1:]:
            if not line.startswith("///"):
                break
            comment.append(line[4:])
        yield f"/** @example {program.name}\n@details"
        yield from (f"{line}  " for line in comment)  # a line each
        yield "*/"


if __name__ == "__main__":
    lines = examples(sys.argv[2]) if sys.argv[1] == "--examples" else page(os.path.relpath(sys.argv[1]))
    print("\n".join(lines))
