#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the type stubs of the module: make_stubs.py > quadtune/__init__.pyi.

The signatures are those that pybind11 writes as the first line of each docstring.
"""

import inspect
import re
import sys
import textwrap
from pathlib import Path

# The module that was built, not its sources beside this script.
sys.path = [folder for folder in sys.path if folder != str(Path(__file__).resolve().parent)]
import quadtune  # noqa: E402

HEADER = '''\
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
Path = Union[str, os.PathLike[str]]
VehicleLike = Union[str, os.PathLike[str], "Vehicle"]
Numbers = Union[float, Sequence[float], Array]
ComplexNumbers = Union[complex, Sequence[complex], Array, ComplexArray]
Grid = Union[str, Mapping[str, Union[float, Sequence[float], Array]]]
Names = Union[str, Sequence[str]]
ByLoop = Union[float, str, Mapping[str, float]]

__version__: str
'''

RESULTS = [
    (r"numpy\.ndarray\[numpy\.complex128(\[[^\]]*\])?\]", "ComplexArray"),
    (r"numpy\.ndarray\[numpy\.float64(\[[^\]]*\])?\]", "Array"),
    (r"numpy\.ndarray\[bool\]", "BoolArray"),
    (r"numpy\.ndarray", "Array"),
    (r"os\.PathLike", "Path"),
    (r"quadtune\._quadtune\.|quadtune\.", ""),
]
ARGUMENTS = [(r"numpy\.ndarray(\[(numpy\.\w+|bool)(\[[^\]]*\])?\])?", "npt.ArrayLike")] + RESULTS


def converted(text, rules):
    for pattern, replacement in rules:
        text = re.sub(pattern, replacement, text)
    return text


def signature(line, name, method):
    """The first line of a docstring as the line of a stub."""
    arguments, result = line[len(name):].rsplit(" -> ", 1)
    arguments = converted(arguments, ARGUMENTS)
    if method:
        arguments = re.sub(r"^\((self|arg0): [\w.]+", "(self", arguments)
    return f"def {name}{arguments} -> {converted(result, RESULTS)}:"


def documented(line, doc, indent=""):
    """A function's line with its docstring."""
    lines = textwrap.dedent(doc).strip() or "..."
    quoted = '"""' + lines.replace("\n", "\n" + indent + "    ") + '"""'
    quoted = "\n".join(part.rstrip() for part in quoted.split("\n"))
    return f"{indent}{line}\n{indent}    {quoted}\n"


def overloads(name, function):
    """(signature, docstring) of each overload."""
    doc = function.__doc__
    if "Overloaded function." not in doc:
        line, _, rest = doc.partition("\n")
        return [(line, rest)]
    found = re.split(rf"^\d+\. (?={re.escape(name)}\()", doc, flags=re.MULTILINE)[1:]
    return [tuple(part.split("\n", 1)) for part in found]


def function_stub(name, function, indent="", method=False):
    found = overloads(name, function)
    text = ""
    for line, doc in found:
        if len(found) > 1:
            text += f"{indent}@overload\n"
        text += documented(signature(line, name, method), doc, indent)
    return text


def property_stub(name, member):
    result = member.fget.__doc__.split("\n")[0].rsplit(" -> ", 1)[1]
    line = f"def {name}(self) -> {converted(result, RESULTS)}:"
    return "    @property\n" + documented(line, member.__doc__, "    ")


def class_stub(name, type_):
    bases = [base.__name__ for base in type_.__bases__ if base.__module__ == "builtins"]
    is_error = issubclass(type_, Exception)
    text = f"class {name}({bases[0]}):\n" if is_error else f"class {name}:\n"
    text += '    """' + type_.__doc__ + '"""\n\n'
    if is_error:
        return text + "    where: str\n"
    for member_name, member in vars(type_).items():
        if isinstance(member, property):
            text += property_stub(member_name, member)
        elif member_name in ("__getitem__", "__contains__", "__len__") or (
                member_name == "__init__" and member.__doc__.startswith("__init__(")) or (
                inspect.isroutine(member) and not member_name.startswith("_")):
            text += function_stub(member_name, member, "    ", method=True)
    return text


def stubs():
    text = HEADER
    for name in quadtune.__all__:
        member = getattr(quadtune, name)
        stub = class_stub if isinstance(member, type) else function_stub
        text += "\n" + stub(name, member)
    return text


if __name__ == "__main__":
    sys.stdout.write(stubs())
