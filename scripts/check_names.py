#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds names that two sources of one folder define in their unnamed namespaces: check_names.py ROOT

Sources of a folder are compiled together (cmake/Batches.cmake), and their unnamed namespaces are then
one scope: a constant that is defined twice does not compile, and of two functions with different
parameters a call may select the one of the other source. A local variable must not hide a name that
another source of its folder declares by `using`: the compiler warns of it. Exit status 1 if there is
such a name.
"""
import collections
import pathlib
import re
import sys

FOLDERS = ['lib', 'linearize', 'discretize', 'synthesis', 'tuning', 'exports', 'workbench', 'report',
           'cli', 'tests']
# Folders whose sources are compiled one by one: the verbs, and the fuzz targets.
ONE_BY_ONE = ['cli', 'cli/tune', 'tests/fuzz']

# Definitions as clang-format writes them, at the start of a line.
DEFINITION = [
    re.compile(r'^(?:constexpr|const|static|inline) [^(=]*?\b(\w+)(?:\[[^\]]*\])?(?: =|\{|\()'),
    re.compile(r'^(?:struct|class|enum class|enum) (?:\[\[\w+\]\] )?(\w+)'),
    re.compile(r'^(?!(?:template|requires|extern)\b)(?:\[\[[^\]]*\]\] )?[A-Za-z_][\w:<>,&*\s\[\]]*[\s&*](\w+)\('),
    re.compile(r'^[A-Za-z_][\w:<>,]* (\w+)(?: =|;|\{)'),
]
# The same alias may be declared twice.
ALIAS = re.compile(r'^(?:using|namespace) (\w+) = (.*);')


def names_of(path):
    """Returns {name: (line, what it names if it is an alias)} for the unnamed namespaces of a source."""
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


def hidden_names(paths):
    """Yields (path, line, name, where) for local variables that hide a using-declaration of a neighbour."""
    declared = {}
    for path in sorted(paths):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if match := re.match(r'using (?:::)?(?:\w+::)+([a-z]\w*);', line):
                declared.setdefault(match.group(1), (path, f'{path.name}:{number}'))
    if not declared:
        return
    variable = re.compile(r'^\s+(?:const |auto |constexpr )*[\w:<>, ]+[ &*]+(' + '|'.join(declared) +
                          r')(?: = |;|\{)')
    for path in sorted(paths):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = variable.match(line)
            if match and not line.lstrip().startswith(('return ', 'using ')):
                yield path, number, match.group(1), declared[match.group(1)][1]


def main():
    clashes = 0
    root = pathlib.Path(sys.argv[1])
    folders = collections.defaultdict(list)
    for top in FOLDERS:
        for path in (root / top).rglob('*.cpp'):
            folders[path.parent].append(path)
    for folder, paths in sorted(folders.items()):
        if str(folder.relative_to(root)) in ONE_BY_ONE:
            continue
        first = {}
        for path in sorted(paths):
            for name, (line, alias) in names_of(path).items():
                where, other = first.setdefault(name, (f'{path.name}:{line}', alias))
                if where != f'{path.name}:{line}' and (alias is None or alias != other):
                    clashes += 1
                    print(f"{path.relative_to(root)}:{line}: '{name}' is also defined at {where}; "
                          'the sources of a folder are compiled together, so the names in their '
                          'unnamed namespaces must differ')
        for path, line, name, where in hidden_names(paths):
            clashes += 1
            print(f"{path.relative_to(root)}:{line}: the variable '{name}' hides the name that {where} "
                  'declares by using; the sources of a folder are compiled together')
    return 1 if clashes else 0


if __name__ == '__main__':
    sys.exit(main())
