"""How far a model's answer is from the finger itself, and which model is enough."""

from __future__ import annotations

import dataclasses
import functools
import time
from typing import Optional, Sequence

import numpy

from . import _core
from ._contacts import (
    ONE_CONTACT,
    POSITIVE,
    as_numbers,
    check_model,
    check_range,
    models_of,
    takes_contacts,
)
from ._errors import InputError
from ._names import choices
from ._result import Flags, Numbers, Result, Words, of_fields, result, shaped, shaped_rows

QUANTITIES = ("a", "b", "indentation", "area", "peak_pressure", "max_torque")
#: Those within the tolerance make a model usable, as all commands of the program mean it.
USABLE = ("a", "b", "area", "max_torque")


@result
class Errors(Result):
    """Relative errors of each quantity."""

    a: Numbers
    b: Numbers
    indentation: Numbers
    area: Numbers
    peak_pressure: Numbers
    max_torque: Numbers

    def largest(self, quantities: Sequence[str] = QUANTITIES) -> Numbers:
        """The largest of some quantities."""
        return numpy.maximum.reduce([getattr(self, quantity) for quantity in quantities])


@result
class ErrorBound(Result):
    """What is known of a model's errors. Where `known` is false, `bound` is infinite, and `expected`
    and its causes are masked, for a single contact None."""

    model: Words  #: whose errors they are; an array where each contact got the recommended one
    known: Flags  #: bool
    bound: Errors  #: of the size of the error, in 95 % of all contacts
    expected: Optional[Errors]  #: signed: the model's answer over the finger's, less 1; the sum of
    by_model: Optional[Errors] = dataclasses.field(
        repr=False
    )  #: the model's own error, for a flat layer in linear theory
    by_strain: Optional[Errors] = dataclasses.field(repr=False)  #: what strain of the layer costs
    by_slope: Optional[Errors] = dataclasses.field(
        repr=False
    )  #: slope of the surfaces at the contact's edge
    by_curvature: Optional[Errors] = dataclasses.field(repr=False)  #: curvature of the layer
    outside: Words  #: why nothing is known, in words; "" where it is

    def usable(self, tolerance: float = 0.1, quantities: Sequence[str] = USABLE) -> Flags:
        """Whether a, b, area and torque are within the tolerance (relative), as `softfinger predict`
        says it for bodies whose radii are exact; or other quantities."""
        return self.known & (self.bound.largest(quantities) <= tolerance)


def _expected_errors(rows, known, shape):
    """None for a single contact of which nothing is known."""
    if not shape and not known:
        return None
    return Errors(*shaped_rows(rows, shape, known))


def _bound_at_once(arguments):
    fields = ONE_CONTACT.error_bound(arguments)
    if fields is None:
        return None
    for name, value in fields.items():
        if isinstance(value, dict):
            fields[name] = of_fields(Errors, value)
    return of_fields(ErrorBound, fields)


@functools.partial(takes_contacts, at_once=_bound_at_once)
def error_bound(contacts, model: Optional[str] = None) -> ErrorBound:
    """The errors of a model, against finite elements of the whole finger: neo-Hookean layer on a
    rigid core, bent over a finger of the given curvature.

    The model is compared with `fingertip_layer`, which was fitted to finite-element runs, and with
    what 95 % of them differ from it. Costs two predictions. Other threads run meanwhile.

    Args:
        model: a name out of `models()`; default: the recommended one for each contact

    Returns:
        ErrorBound, whose numbers have the shape to which the arguments broadcast
    """
    common, names = models_of(contacts, check_model("error_bound", model))
    shape = contacts.shape
    known, expected, causes, bound, outside = _core.error_bound(common, contacts.numbers)
    if model == "power_law":  # as in the program: the bounds are of theories
        known[:], bound[:] = False, numpy.inf
        outside = ["a measured law holds for the finger that it was measured on"] * known.size
    return ErrorBound(
        names,
        shaped(known, shape),
        Errors(*shaped_rows(bound, shape)),
        _expected_errors(expected, known, shape),
        *(_expected_errors(cause, known, shape) for cause in causes),
        shaped(numpy.array(outside, dtype=object), shape) if shape else outside[0],
    )


@result
class Choice(Result):
    """The fast model with the least bound among those that are accurate enough, for each contact."""

    model: Words  #: its name; "" where none is known to meet the tolerance
    bound: Numbers  #: its largest error among the quantities asked for; infinite without a model
    #: measured here, per contact, by model
    cost_s: dict[str, float] = dataclasses.field(repr=False)
    bounds: dict[str, ErrorBound] = dataclasses.field(repr=False)  #: ErrorBound by model


@takes_contacts
def select(
    contacts,
    tolerance: float = 0.1,
    models: Optional[Sequence[str]] = None,
    quantities: Sequence[str] = USABLE,
) -> Choice:
    """The fast model whose stated error is within a tolerance, and the least, for each contact.

    Fast models (`ModelCard.is_fast`) count as equally cheap, as `softfinger select` has it, so that
    the choice does not change from run to run; that knows the slow ones and finite elements, too.
    The cost, for information, is that of a prediction of all these contacts, measured.

    Args:
        tolerance: of every chosen quantity, relative; positive and finite
        models: names of those allowed; default: all fast ones
        quantities: out of "a", "b", "indentation", "area", "peak_pressure", "max_torque"; default:
            a, b, area and max_torque

    Returns:
        Choice, whose arrays have the shape to which the arguments broadcast
    """
    wanted = as_numbers("select", "tolerance", tolerance)
    if wanted.shape:
        raise InputError("select", "tolerance", tolerance, "one number for all contacts")
    check_range("select", "tolerance", wanted, POSITIVE)
    quantities = (quantities,) if isinstance(quantities, str) else tuple(quantities)
    for quantity in quantities:
        if quantity not in QUANTITIES:
            raise InputError("select", "quantities", quantity, choices(quantity, QUANTITIES))
    if not quantities:
        raise InputError("select", "quantities", quantities, "at least one")
    cards = [card for card in _core.models() if card["is_fast"]]
    fast = [card["name"] for card in cards]
    # For one layer the model of several would be listed twice.
    usual = [card["name"] for card in cards if not card["is_for_several_layers"]]
    names = usual if models is None else [models] if isinstance(models, str) else list(models)
    for name in names:
        if name not in fast:
            raise InputError("select", "models", name, choices(name, fast))
    if not names:
        raise InputError("select", "models", models, "at least one of " + ", ".join(fast))
    cost_s = {name: _cost_s(name, contacts) for name in names}
    bounds = {name: error_bound.of_contacts(contacts, name) for name in names}
    chosen = numpy.full(contacts.shape, "", dtype=object)
    bound = numpy.full(contacts.shape, numpy.inf)
    for name in names:
        worst = numpy.asarray(bounds[name].bound.largest(quantities))
        better = (worst <= tolerance) & (worst < bound)
        chosen, bound = numpy.where(better, name, chosen), numpy.where(better, worst, bound)
    return Choice(shaped(chosen, contacts.shape), shaped(bound, contacts.shape), cost_s, bounds)


def _cost_s(name, contacts):
    """Seconds per contact, the least of three."""
    count = contacts.numbers["normal_force_N"].size
    if count == 0:
        return 0.0
    # Of few contacts the call would be measured, not the model.
    many = {
        name: numpy.resize(x, max(count, 1000)) if isinstance(x, numpy.ndarray) else x
        for name, x in contacts.numbers.items()
    }
    times = []
    for _ in range(3):
        start = time.perf_counter()
        _core.predict(name, many)
        times.append(time.perf_counter() - start)
    return min(times) / max(count, 1000)
