"""What all results have in common.

One rule for what is not known: it is never a number. An array of results is a masked array there
(numpy.ma), with NaN beneath the mask for who takes it off; flags (`has_answer`, `known`) say the same.
A single contact without an answer is a NoAnswer, which is raised, and a field of a single result
that may be unknown is None.
"""

from __future__ import annotations

import dataclasses
import textwrap
from typing import Union

import numpy

from ._names import unknown_attribute

Numbers = Union[float, numpy.ndarray]
Flags = Union[bool, numpy.ndarray]
Words = Union[str, numpy.ndarray]

#: Makes a class one of results. The text of a result is `Result`'s.
result = dataclasses.dataclass(frozen=True, eq=False, repr=False)


class Result:
    """Base of the results, which are frozen dataclasses.

    Numbers are arrays of the shape to which the arguments broadcast, or Python's own numbers where
    all arguments are scalars. Equal means: the same type and the same numbers.
    """

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        return all(
            _are_equal(getattr(self, field.name), getattr(other, field.name))
            for field in dataclasses.fields(self)
        )

    __hash__ = None

    def __repr__(self):
        fields = [field.name for field in dataclasses.fields(self) if field.repr]
        texts = [f"{name}={_text_of(getattr(self, name))}" for name in fields]
        # Lines end between fields, and within long ones.
        kept = [text.replace(" ", _KEPT) if len(text) < 90 else text for text in texts]
        return textwrap.fill(
            f"{type(self).__name__}({', '.join(kept)})",
            width=100,
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        ).replace(_KEPT, " ")

    def __getattr__(self, name):  # only for what is not there
        raise unknown_attribute(type(self).__name__, name, dir(type(self)) + list(vars(self)))


_KEPT = "\N{NO-BREAK SPACE}"
_SHORT = 140  # characters; what is longer is told by its kind and size


def _text_of(value):
    """A value in a line: six digits, and of what is long its kind and its size."""
    if isinstance(value, numpy.ndarray):
        return _text_of_array(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        text = "{" + ", ".join(f"{key}: {_text_of(x)}" for key, x in value.items()) + "}"
        return text if len(text) <= _SHORT else "{" + ", ".join(map(str, value)) + "}"
    if isinstance(value, (tuple, list)):
        text = "(" + ", ".join(map(_text_of, value)) + ")"
        return text if len(text) <= _SHORT else f"({len(value)} of {type(value[0]).__name__})"
    text = " ".join(repr(value).split())
    if isinstance(value, Result) and len(text) > _SHORT:
        return "(..)"
    return text


def _text_of_array(values):
    if values.size <= 3:
        return _text_of_list(values.tolist())
    if values.dtype.kind == "f":
        known = numpy.ma.compressed(values)
        span = f": {known.min():.3g} to {known.max():.3g}" if known.size else ""
        return f"<{values.shape}{span}>"
    if values.dtype.kind == "b":
        return f"<{values.shape}: {int(values.sum())} true>"
    return f"<{values.shape}: {', '.join(map(repr, sorted(set(values.flat))))}>"


def _text_of_list(values):
    """Of an array as nested lists, in which None is masked."""
    if isinstance(values, list):
        return "[" + ", ".join(map(_text_of_list, values)) + "]"
    return "--" if values is None else _text_of(values)


def _are_equal(one, other):
    """NaN lies beneath what is masked, and equals NaN."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_are_equal(one[k], other[k]) for k in one)
    if isinstance(one, numpy.ndarray) and one.dtype.kind == "f":
        return numpy.array_equal(numpy.asarray(one), numpy.asarray(other), equal_nan=True)
    return numpy.array_equal(one, other)


def of_fields(kind, fields):
    """A result whose fields are known to be right: its constructor takes ten times as long."""
    made = object.__new__(kind)
    object.__setattr__(made, "__dict__", fields)
    return made


def shaped(values, shape):
    """Values of a flat array in their shape; a number of Python's own for the shape ()."""
    return values.reshape(shape) if shape else values.item()


def shaped_rows(rows, shape, known=True):
    """Each row in its shape, masked where it is not known; for the shape () numbers as they are."""
    if not shape:
        return rows[:, 0].tolist()
    return [shaped(masked(row, known), shape) for row in rows]


def masked(values, known):
    """The values where they are known, masked elsewhere; as they are where all are known."""
    known = numpy.asarray(known)
    if known.all():
        return values
    return numpy.ma.array(
        numpy.where(known, values, numpy.nan),
        mask=numpy.broadcast_to(~known, numpy.shape(values)).copy(),
        fill_value=numpy.nan,
    )


def masked_where_nan(values):
    """What a NaN marks as missing becomes masked."""
    return masked(values, ~numpy.isnan(values))
