#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds words that docs/glossary.md replaces: check_words.py FILE...

Looks at the prose of Markdown files outside of code, and at comments and messages of C++ sources.
Prints one line per finding; exit status 1 if there is one.
"""
import pathlib
import re
import sys

# What is found, and what to write instead.
PHRASES = [
    (r'(?<!to )(?<!cannot )\btells?\b|\btold\b', 'state, report, print, determine'),
    (r'(?<!the )\bexpected (?:one|some)(?=["]|$|[.,;])', 'name what was expected'),
    (r'\bstands? twice\b', 'is defined twice'),
    (r'\bbeside\b', 'in addition to, next to, compared with'),
    (r'\bmade[ -]up\b', 'simulated'),
    (r'\bgiv(?:e|es|ing) up\b', 'abort'),
    (r'\blook(?:s|ed)? at\b', 'inspect, examine'),
    (r'(?<!the )(?<!range\.)\bgreatest\b|\blesser\b', 'maximum, smaller'),
    (r'\b(?:whoever|whatever it was)\b', 'name the subject'),
    (r'\bknows? of\b', 'depends on'),
    (r'\bmend(?:s|ed|ing)?\b', 'fix'),
    (r'\bplant that is none\b|\bthat is none\b', 'malformed'),
    (r'\bexpected it as it was\b', 'restore it'),
    (r'\btake[ns]? up(?! to\b)', 'accept'),
]
PATTERNS = [(re.compile(pattern, re.IGNORECASE), advice) for pattern, advice in PHRASES]

# Comments and strings of C++, in one pass so that neither hides the other.
TOKEN = re.compile(r'R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|'
                   r'//[^\n]*|/\*(?:.|\n)*?\*/')
# Words that programs read, kept as they are.
NAMES = re.compile(r'`[^`]*`|\w*_\w*|\b\w+\(\)|https?://\S+')


def prose_of_markdown(text):
    """Yields (line number, text) outside of fences, without code in backticks."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith('```'):
            fenced = not fenced
        elif not fenced and not line.startswith('    '):
            yield number, NAMES.sub('', line)


def prose_of_source(text):
    """Yields (line number, text) of comments and of strings that are sentences."""
    for match in TOKEN.finditer(text):
        token = match.group(0)
        if token[0] == "'" or (token[0] in '"R' and ' ' not in token):
            continue  # a key or a name
        number = text.count('\n', 0, match.start()) + 1
        for offset, line in enumerate(token.splitlines()):
            yield number + offset, NAMES.sub('', line)


def main(files):
    found = 0
    for name in files:
        path = pathlib.Path(name)
        text = path.read_text(encoding='utf-8')
        prose = prose_of_markdown if path.suffix == '.md' else prose_of_source
        for number, line in prose(text):
            for pattern, advice in PATTERNS:
                match = pattern.search(line)
                if match:
                    print(f"{name}:{number}: '{match.group(0)}'; write: {advice}")
                    found += 1
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
