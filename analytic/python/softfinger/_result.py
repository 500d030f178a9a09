"""What all results have in common."""

from __future__ import annotations

import dataclasses

from typing import Union

import numpy

Numbers = Union[float, numpy.ndarray]
Flags = Union[bool, numpy.ndarray]
Words = Union[str, numpy.ndarray]


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


def _are_equal(one, other):
    """NaN, which stands for what was not measured, equals NaN."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_are_equal(one[k], other[k]) for k in one)
    if isinstance(one, numpy.ndarray) and one.dtype.kind == "f":
        return numpy.array_equal(one, other, equal_nan=True)
    if isinstance(one, float) and one != one:
        return isinstance(other, float) and other != other
    return numpy.array_equal(one, other)


def shaped(values, shape):
    """Values of a flat array in their shape; a number of Python's own for the shape ()."""
    return values.reshape(shape) if shape else values.item()
