#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names of unnamed namespaces that two sources of one folder define.

Sources of a folder are compiled together (cmake/Batches.cmake), where such names share a scope: two
constants clash, and of two functions with different parameters a call could choose the neighbour's.
"""
import collections
import pathlib
import re
import sys

DEFINITION = [
    re.compile(r'^(?:constexpr|const|static|inline) [^(=]*?\b(\w+)(?:\[[^\]]*\])?(?: =|\{|\()'),
    re.compile(r'^(?:struct|class|enum class|enum) (?:\[\[\w+\]\] )?(\w+)'),
    re.compile(r'^(?!(?:template|requires|extern)\b)(?:\[\[[^\]]*\]\] )?[A-Za-z_][\w:<>,&*\s\[\]]*[\s&*](\w+)\('),
    re.compile(r'^[A-Za-z_][\w:<>,]* (\w+)(?: =|;|\{)'),
]


# The same alias may be declared twice.
ALIAS = re.compile(r'^(?:using|namespace) (\w+) = (.*);')


def names_of(path):
    """The names that a source defines in its unnamed namespaces: their lines, and what aliases name."""
    names = {}
    inside = 0
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line.startswith('namespace {'):
            inside = number
        elif line == '}  // namespace':
            inside = 0
        elif inside and (match := ALIAS.match(line)):
            names.setdefault(match.group(1), (number, match.group(2)))
        elif inside and re.match(r'(?!using |namespace )[A-Za-z_\[]', line):
            for pattern in DEFINITION:
                match = pattern.match(line)
                if match:
                    names.setdefault(match.group(1), (number, None))
                    break
    return names


def main():
    clashes = 0
    folders = collections.defaultdict(list)
    for name in sys.argv[1:]:
        path = pathlib.Path(name)
        folders[path.parent].append(path)
    for folder, paths in sorted(folders.items()):
        first = {}
        for path in sorted(paths):
            for name, (line, alias) in names_of(path).items():
                where, other = first.setdefault(name, (f'{path.name}:{line}', alias))
                if where != f'{path.name}:{line}' and (alias is None or alias != other):
                    clashes += 1
                    print(f'{path}:{line}: {name} is also a name of {where}; sources of one folder '
                          'are compiled together, so its name must differ')
    return 1 if clashes else 0


if __name__ == '__main__':
    sys.exit(main())
