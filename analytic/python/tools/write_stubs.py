"""Writes the stubs of the package, softfinger/__init__.pyi, arrays.pyi and plot.pyi, from the package
itself.

usage: python3 analytic/python/tools/write_stubs.py FOLDER     with the built package in PYTHONPATH

The functions of contacts get their parameters at run time (softfinger/_contacts.py), where type
checkers do not see them.
"""

import dataclasses
import inspect
import pathlib
import sys

import softfinger
import softfinger.arrays
import softfinger.plot

HEAD = """# Written by analytic/python/tools/write_stubs.py; do not edit.
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike
"""
ALIASES = """
Numbers = Union[float, numpy.ndarray]
Flags = Union[bool, numpy.ndarray]
Words = Union[str, numpy.ndarray]
Curvature = Union[ArrayLike, tuple[ArrayLike, ArrayLike], "QuadricFit"]

__version__: str
"""


def text_of(annotation):
    annotation = getattr(annotation, "__forward_arg__", annotation)  # of a NamedTuple
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", "None")


def signature_text(function):
    """The parameters and what is returned; defaults as `...`."""
    signature = inspect.signature(function)
    parts, star = [], False
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not star:
            parts.append("*")
            star = True
        text = {parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "") + parameter.name
        if parameter.annotation is not parameter.empty:
            text += f": {text_of(parameter.annotation)}"
        if parameter.default is not parameter.empty:
            text += " = ..." if ":" in text else "=..."
        parts.append(text)
    returns = signature.return_annotation
    arrow = "" if returns is signature.empty else f" -> {text_of(returns)}"
    return f"({', '.join(parts)}){arrow}: ..."


def members(kind):
    """Public methods and properties of a class itself, and of the private classes it is made of."""
    lines, own = [], {}
    for part in reversed(kind.__mro__):
        if part is kind or part.__name__.startswith("_"):
            own.update(vars(part))
    for name, member in own.items():
        if name.startswith("_") and not (name == "__init__" and not dataclasses.is_dataclass(kind)):
            continue
        if isinstance(member, property):
            lines += ["@property", f"def {name}{signature_text(member.fget)}"]
        elif isinstance(member, classmethod):
            lines += ["@classmethod", f"def {name}{signature_text(member.__func__)}"]
        elif inspect.isfunction(member):
            lines.append(f"def {name}{signature_text(member)}")
    return lines


def class_text(kind):
    base = None if dataclasses.is_dataclass(kind) or kind.__base__ is object else kind.__base__
    body = [f"{name}: {text_of(annotation)}" for name, annotation in annotations(kind).items()]
    if dataclasses.is_dataclass(kind):
        body.append(f"def __init__{signature_text(kind.__init__)}")
    name = "NamedTuple" if base is tuple else getattr(base, "__name__", "")
    head = f"class {kind.__name__}" + (f"({name})" if name else "") + ":"
    return "\n    ".join([head, *(body + members(kind) or ["..."])]) + "\n"


def annotations(kind):
    """Of the fields of a dataclass, inherited ones too; of another class its own."""
    if dataclasses.is_dataclass(kind):
        return {field.name: field.type for field in dataclasses.fields(kind)}
    return vars(kind).get("__annotations__", {})


def stub_of(names, module):
    text = ""
    for name in names:
        value = getattr(module, name)
        text += "\n" + (
            class_text(value) if inspect.isclass(value) else f"def {name}{signature_text(value)}\n"
        )
    return text


def stubs():
    """The text of each stub, by file name."""
    plots = [name for name in vars(softfinger.plot) if name.startswith("plot_")]
    return {
        "__init__.pyi": HEAD + ALIASES + stub_of(softfinger.__all__, softfinger),
        "arrays.pyi": HEAD
        + "from typing import NamedTuple\n\nfrom softfinger import FlatPad\n"
        + stub_of(softfinger.arrays.__all__, softfinger.arrays),
        "plot.pyi": HEAD
        + "\nfrom softfinger import Calibration, FrictionEllipsoid, LimitSurface, ShearSurface\n"
        + stub_of(plots, softfinger.plot),
    }


if __name__ == "__main__":
    for name, text in stubs().items():
        pathlib.Path(sys.argv[1], name).write_text(text, encoding="utf-8")
