# SPDX-License-Identifier: Apache-2.0
"""One-line messages for calls whose arguments fit no signature of a function.

pybind11 lists all signatures and all arguments instead.
"""

import difflib
import functools
import os
import re


class _Signature:
    """One of the signatures that pybind11 lists: "(A: Matrix, *, dt: Optional[float] = None)"."""

    def __init__(self, text):
        self.kinds = {}  # name: annotation, in order
        self.required = []
        self.positional = []
        keyword_only = False
        for part in _parts(text):
            if part == "*":
                keyword_only = True
                continue
            name, _, rest = part.partition(": ")
            annotation, _, default = rest.partition(" = ")
            self.kinds[name] = annotation
            if not default:
                self.required.append(name)
            if not keyword_only:
                self.positional.append(name)

    def problems(self, args, kwargs):
        """What prevents a call with these arguments: sentences about names, and about values."""
        found = [f"argument {i + 1} is unexpected" for i in range(len(self.positional), len(args))]
        given = dict(zip(self.positional, args))
        for name, value in kwargs.items():
            if name in given:
                found.append(f"{name} is given twice")
            elif name not in self.kinds:
                others = " and ".join(self.positional or self.required)
                found.append(f"{name} cannot be combined with {others}")
            given[name] = value
        found += [f"{name} is missing" for name in self.required if name not in given]
        wrong = []
        for name, value in given.items():
            expected = _expected(self.kinds.get(name, ""), value)
            if expected:
                wrong.append(f"{name} is {_shown(value)}, expected {expected}")
        return found, wrong

    def __str__(self):
        words = [name if name in self.positional else f"{name}=" for name in self.required]
        return ", ".join(words + (["..."] if len(self.kinds) > len(self.required) else []))


def _parts(text):
    """Splits at the commas that are outside of all brackets."""
    parts, depth, start = [], 0, 0
    for i, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    return [part for part in [*parts, text[start:].strip()] if part]


def _shown(value):
    text = repr(value)
    kind = type(value).__name__
    return f"{text} ({kind})" if len(text) <= 40 and "\n" not in text else f"a value of type {kind}"


def _dimensions(value):
    """The number of dimensions of an array or of nested sequences; None for text."""
    if isinstance(value, (str, bytes)):
        return None
    if hasattr(value, "ndim"):
        return value.ndim
    if isinstance(value, (list, tuple)):
        inner = [_dimensions(one) for one in value]
        return None if None in inner else 1 + max(inner, default=0)
    return 0 if hasattr(value, "__float__") or hasattr(value, "__complex__") else None


def _expected(annotation, value):
    """What the annotation expects in place of the value; empty if it may fit."""
    optional = re.fullmatch(r"Optional\[(.*)\]", annotation)
    if optional:
        return "" if value is None else _expected(optional[1], value)
    dimensions = _dimensions(value)
    is_path = isinstance(value, (str, os.PathLike))
    is_list = isinstance(value, (list, tuple))
    is_dict = hasattr(value, "keys")
    rules = {
        "float": (dimensions == 0, "a number"),
        "int": (hasattr(value, "__index__") and value >= 0, "an integer of 0 or more"),
        "bool": (isinstance(value, bool), "True or False"),
        "str": (isinstance(value, str), "a text"),
        "Path": (is_path, "a path"),
        "Numbers": (dimensions in (0, 1, 2), "a number or a list of numbers"),
        "ComplexNumbers": (dimensions is not None, "a number or a list of numbers"),
        "Names": (isinstance(value, str) or is_list, "a name or a list of names"),
        "List[Names]": (is_list, "a list of names"),
        "List[Path]": (is_list, "a list of files or names"),
        "ByLoop": (dimensions == 0 or isinstance(value, str) or is_dict,
                   "a number, or a number for each loop by its name, such as {'roll': 40}"),
        "Grid": (isinstance(value, str) or is_dict,
                 "a grid, such as 'speed=0:0.5:10' or {'speed': [0, 5, 10]}"),
        "Dict[str, str]": (is_dict, "texts by name, such as {'height': 'baro'}"),
        "Dict[str, float]": (is_dict, "numbers by name, such as {'R.sonar': 0.01}"),
        "VehicleLike": (is_path or type(value).__name__ == "Vehicle",
                        "a built-in vehicle, a vehicle file or a Vehicle"),
        "Tuple[float, float]": (dimensions == 1 and len(value) == 2, "two numbers (low, high)"),
    }
    if annotation.endswith(".Controller"):
        fits, expected = type(value).__name__ == "Controller", "a Controller"
    elif annotation.startswith("numpy.ndarray"):
        fits, expected = dimensions in (1, 2), "a matrix, such as [[1, 0], [0, 1]]"
    else:
        fits, expected = rules.get(annotation, (True, ""))
    return "" if fits else expected


def _signatures(error):
    """The signatures that the error lists; none if it has another cause."""
    if "incompatible function arguments" not in str(error):
        return []
    return [_Signature(found[1]) for found in
            re.finditer(r"^ {4}\d+\. \((.*)\) -> .*$", str(error), re.MULTILINE)]


def _message(name, signatures, args, kwargs):
    known = {one for signature in signatures for one in signature.kinds}
    for word in kwargs:
        if word not in known:
            similar = difflib.get_close_matches(word, known, 1)
            return (f"{name}() has no argument '{word}'"
                    + (f"; did you mean '{similar[0]}'?" if similar else ""))
    calls = " or ".join(f"{name}({signature})" for signature in signatures)
    names, values = min((signature.problems(args, kwargs) for signature in signatures),
                        key=lambda found: len(found[0]) + len(found[1]))
    if names:
        return f"{name}(): {'; '.join(names + values)}; expected {calls}"
    if values:
        return f"{name}(): {'; '.join(values)}"
    came = [_shown(value) for value in args]
    came += [f"{word}={_shown(value)}" for word, value in kwargs.items()]
    return (f"{name}(): {', '.join(came)} do not have the types or ranges of {calls}; "
            f"help(quadtune.{name}) lists them")


def explained(function):
    """The function, with a message of one line if its arguments fit none of its signatures."""

    @functools.wraps(function)
    def call(*args, **kwargs):
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            signatures = _signatures(error)
            if not signatures:  # an error of another kind
                raise
            message = _message(function.__name__, signatures, args, kwargs)
        raise TypeError(message)

    return call
