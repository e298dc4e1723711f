#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a page of the documentation: run_page.py PROGRAM SOURCE PAGE [--update]

In a fenced block of the language `console`, a line that begins with "$ " is a command for bash, and
the lines below it are what it prints, both streams together. A line "..." stands for any number of
lines. A command must exit with 0, unless it ends with "# exit status N". The commands of a page run
one after another in one folder, which has links to the vehicles,
missions, designs and other examples of SOURCE; the program is found as `quadtune`. A block below the
line `<!-- not run: WHY -->` is left out. Fences of the language `toml` or `python` whose first line
is "# FILE.toml" or "# FILE.py" are written to that file first.

With --update, output without a line "..." is replaced by what is printed. Exit status 1 if a command
prints something else, or there is no command at all.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

LINKED = ['vehicles', 'missions', 'designs', 'campaigns', 'filters', 'docs', 'examples']
LIMIT_S = 600


def fences(lines):
    """Yields (language, first line of the content, line after it, expression of what may differ) for
    each fenced block that runs."""
    number = 0
    while number < len(lines):
        opened = re.match(r'```(\w+)\s*$', lines[number])
        if not opened:
            # An unnamed fence is passed over as a whole.
            if lines[number].startswith('```'):
                number += 1
                while number < len(lines) and not lines[number].startswith('```'):
                    number += 1
            number += 1
            continue
        first = number + 1
        end = first
        while end < len(lines) and not lines[end].startswith('```'):
            end += 1
        above = lines[number - 1] if number > 0 else ''
        may_differ = re.match(r'<!-- may differ: (.*) -->$', above)
        if not above.startswith('<!-- not run'):
            yield opened.group(1), first, end, may_differ and may_differ.group(1)
        number = end + 1


def commands(lines, first, end):
    """Yields (line of the command, first line of its output, line after it)."""
    starts = [n for n in range(first, end) if lines[n].startswith('$ ')]
    for start, stop in zip(starts, starts[1:] + [end]):
        output = start + 1
        while lines[output - 1].endswith('\\') and output < stop:
            output += 1
        yield start, output, stop


def matches(expected, printed):
    """Whether the printed lines are the expected ones, where "..." stands for any number of lines."""
    if not expected:
        return not printed
    if expected[0].strip() == '...':
        return any(matches(expected[1:], printed[n:]) for n in range(len(printed) + 1))
    return bool(printed) and printed[0] == expected[0] and matches(expected[1:], printed[1:])


def masked(lines, may_differ):
    """The lines without what may differ."""
    return [re.sub(may_differ, '~', line) for line in lines] if may_differ else lines


def environment(program, folder):
    """The environment of a command: the program first on the path, nothing that changes output."""
    tools = folder / 'bin'
    tools.mkdir()
    (tools / 'quadtune').symlink_to(program)
    values = dict(os.environ, PATH=f'{tools}:{os.environ["PATH"]}', LC_ALL='C.UTF-8')
    values.pop('COLUMNS', None)
    return values


def run_page(program, source, page, update):
    """Returns the number of commands and of those that printed something else."""
    lines = page.read_text(encoding='utf-8').splitlines()
    ran = wrong = 0
    changes = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        values = environment(program, folder)
        work = folder / 'work'
        work.mkdir()
        for entry in LINKED:
            if (source / entry).exists():
                (work / entry).symlink_to(source / entry)
        for language, first, end, may_differ in fences(lines):
            named = first < end and re.match(r'# ([\w-]+\.(?:toml|py))$', lines[first])
            if language in ('toml', 'python') and named:
                (work / named.group(1)).write_text('\n'.join(lines[first:end]) + '\n')
            if language != 'console':
                continue
            for start, output, stop in commands(lines, first, end):
                command = '\n'.join(lines[start:output])[2:]
                result = subprocess.run(['bash', '-c', command], cwd=work, env=values, text=True,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, timeout=LIMIT_S, check=False)
                ran += 1
                printed = [line.rstrip() for line in result.stdout.splitlines()]
                expected = [line.rstrip() for line in lines[output:stop]]
                while expected and not expected[-1]:
                    expected.pop()
                while printed and not printed[-1]:
                    printed.pop()
                stated = re.search(r'# exit status (\d+)$', command)
                status = int(stated.group(1)) if stated else 0
                if result.returncode == status and matches(masked(expected, may_differ),
                                                           masked(printed, may_differ)):
                    continue
                if update and result.returncode == status and '...' not in (line.strip() for line in expected):
                    changes.append((output, output + len(expected), printed))
                    continue
                wrong += 1
                print(f'{page}:{start + 1}: $ {command}\nexpected:')
                print('\n'.join(expected))
                print(f'printed (exit status {result.returncode}):')
                print('\n'.join(printed))
    for begin, end, printed in reversed(changes):
        lines[begin:end] = printed
    if changes:
        page.write_text('\n'.join(lines) + '\n', encoding='utf-8')
    return ran, wrong


def main(args):
    update = '--update' in args
    program, source, page = [pathlib.Path(a).resolve() for a in args if a != '--update']
    ran, wrong = run_page(program, source, page, update)
    print(f'{page.name}: {ran} commands, {wrong} printed something else')
    return 1 if wrong or not ran else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
