#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the options on the pages of the verbs with the program: option_tables.py PROGRAM DOCS [--update]

DOCS/cli/VERB.md has a line `<!-- options -->`. Below it, up to `<!-- end of options -->`, stand the
usage and the options of the verb as `quadtune help VERB --json` gives them. With --update they are
written there. Exit status 1 if a page differs, a verb has no page, or a page has no such line.
"""
import json
import pathlib
import subprocess
import sys

BEGIN, END = '<!-- options -->', '<!-- end of options -->'


def help_of(program, *verb):
    """What the program says of a verb, or of itself."""
    printed = subprocess.run([program, 'help', *verb, '--json'], capture_output=True, text=True,
                             check=True).stdout
    return json.loads(printed)


def block(verb):
    """The generated lines of a page."""
    lines = ['', '```', f'quadtune {verb["name"]} {verb["usage"]}'.rstrip(), '```', '',
             f'For example: `{verb["example"]}`', '']
    for option in verb['options']:
        description = option['description']
        lines.append(f'- `{option["option"]}`: {description}')
    return lines + ['']


def main(args):
    update = '--update' in args
    program, docs = [pathlib.Path(a).resolve() for a in args if a != '--update']
    wrong = 0
    for entry in help_of(program)['commands']:
        name = entry['name']
        page = docs / 'cli' / (name.replace(' ', '-') + '.md')
        if not page.exists():
            print(f'{page}: quadtune {name} has no page')
            wrong += 1
            continue
        lines = page.read_text(encoding='utf-8').splitlines()
        if BEGIN not in lines:
            print(f'{page}: has no line {BEGIN}')
            wrong += 1
            continue
        first = lines.index(BEGIN) + 1
        end = lines.index(END) if END in lines else first
        expected = block(help_of(program, *name.split()))
        if lines[first:end] == expected:
            continue
        if update:
            tail = lines[end + 1:] if END in lines else lines[end:]
            page.write_text('\n'.join(lines[:first] + expected + [END] + tail) + '\n', encoding='utf-8')
            continue
        print(f'{page}:{first}: the options differ from those of the program; run '
              'scripts/option_tables.py with --update')
        wrong += 1
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
