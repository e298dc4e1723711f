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
import textwrap

BEGIN, END = '<!-- options -->', '<!-- end of options -->'


def help_of(program, *verb):
    """What the program says of a verb, or of itself."""
    printed = subprocess.run([program, 'help', *verb, '--json'], capture_output=True, text=True,
                             check=True).stdout
    return json.loads(printed)


# Options of every verb; docs/cli.md has them.
COMMON = {'-o FILE', '--json', '--quiet', '--seed N', '--threads N'}


def block(verbs):
    """The generated lines of a page: usage, example and options of each of its verbs."""
    lines = ['']
    for verb in verbs:
        lines += ['```', f'quadtune {verb["name"]} {verb["usage"]}'.rstrip(), '```', '',
                  f'For example: `{verb["example"]}`', '']
        options = [option for option in verb['options'] if option['option'] not in COMMON]
        for option in options:
            lines += textwrap.wrap(f'- `{option["option"]}`: {option["description"]}', 100,
                                   subsequent_indent='  ', break_long_words=False,
                                   break_on_hyphens=False)
        lines += [''] if options else []
    return lines + ['The options of every command are on [the first page](../cli.md#for-every-command).', '']


def pages_of(program, folder):
    """{page: verbs}: a verb of two words has a page of its own or one with the others of its first."""
    pages = {}
    for entry in help_of(program)['commands']:
        words = entry['name'].split()
        own = folder / ('-'.join(words) + '.md')
        page = own if own.exists() else folder / (words[0] + '.md')
        pages.setdefault(page, []).append(help_of(program, *words))
    return pages


def main(args):
    update = '--update' in args
    program, docs = [pathlib.Path(a).resolve() for a in args if a != '--update']
    wrong = 0
    for page, verbs in pages_of(program, docs / 'cli').items():
        lines = page.read_text(encoding='utf-8').splitlines() if page.exists() else []
        if BEGIN not in lines:
            print(f'{page}: missing, or without the line {BEGIN}')
            wrong += 1
            continue
        first = lines.index(BEGIN) + 1
        end = lines.index(END) if END in lines else first
        expected = block(verbs)
        if lines[first:end] == expected:
            continue
        if update:
            tail = lines[end + 1:] if END in lines else lines[end:]
            page.write_text('\n'.join(lines[:first] + expected + [END] + tail) + '\n',
                            encoding='utf-8')
            continue
        print(f'{page}:{first}: the options differ from those of the program; run '
              'scripts/option_tables.py with --update')
        wrong += 1
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
