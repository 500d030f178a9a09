"""How far a model's answer is from the finger itself, and which model is enough."""

from __future__ import annotations

import dataclasses
import time
from typing import Optional, Sequence

import numpy

from . import _core
from ._contacts import (
    as_numbers,
    check_model,
    check_range,
    takes_contacts,
    POSITIVE,
)
from ._result import Flags, Numbers, Result, Words, shaped
from ._errors import InputError

QUANTITIES = ("a", "b", "indentation", "area", "peak_pressure", "max_torque")


@dataclasses.dataclass(frozen=True, eq=False)
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


@dataclasses.dataclass(frozen=True, eq=False)
class ErrorBound(Result):
    """What is known of a model's errors. Where `known` is false, `bound` is infinite and
    `expected` and its causes are zero."""

    model: str
    known: Flags  #: bool
    bound: Errors  #: of the size of the error, in 95 % of all contacts
    expected: Errors  #: signed: the model's answer over the finger's, less 1; the sum of
    by_model: Errors  #: the model's own error, for a flat layer in linear theory
    by_strain: Errors  #: what strain of the layer costs
    by_slope: Errors  #: slope of the surfaces at the contact's edge
    by_curvature: Errors  #: curvature of the layer
    outside: Words  #: why nothing is known, in words; "" where it is

    def usable(self, tolerance: float = 0.1) -> Flags:
        """Whether area and torque are within the tolerance (relative), as `softfinger predict` says
        it for bodies whose radii are exact."""
        return self.known & (self.bound.largest(("area", "max_torque")) <= tolerance)


def _errors(rows, shape):
    return Errors(*(shaped(row, shape) for row in rows))


@takes_contacts
def error_bound(contacts, model: str = "fingertip_layer") -> ErrorBound:
    """The errors of a model, against finite elements of the whole finger: neo-Hookean layer on a
    rigid core, bent over a finger of the given curvature.

    The model is compared with `fingertip_layer`, which was fitted to finite-element runs, and with
    what 95 % of them differ from it. Costs two predictions. Other threads run meanwhile.

    Args:
        model: a name out of `models()`

    Returns:
        ErrorBound, whose numbers have the shape to which the arguments broadcast
    """
    check_model("error_bound", model)
    shape = contacts.shape
    known, expected, causes, bound, outside = _core.error_bound(model, contacts.numbers)
    if model == "power_law":  # as in the program: the bounds are of theories
        known[:], expected[:], causes[:], bound[:] = False, 0, 0, numpy.inf
        outside = ["a measured law holds for the finger that it was measured on"] * known.size
    return ErrorBound(
        model,
        shaped(known, shape),
        _errors(bound, shape),
        _errors(expected, shape),
        *(_errors(cause, shape) for cause in causes),
        shaped(numpy.array(outside, dtype=object), shape) if shape else outside[0],
    )


@dataclasses.dataclass(frozen=True, eq=False)
class Choice(Result):
    """The cheapest model that is accurate enough, for each contact."""

    model: Words  #: its name; "" where none is known to meet the tolerance
    bound: Numbers  #: its largest error among the quantities asked for; infinite without a model
    cost_s: dict[str, float]  #: measured here, per contact, by model
    bounds: dict[str, ErrorBound]  #: ErrorBound by model


@takes_contacts
def select(
    contacts,
    tolerance: float = 0.05,
    models: Optional[Sequence[str]] = None,
    quantities: Sequence[str] = QUANTITIES,
) -> Choice:
    """The cheapest model whose stated error is within a tolerance, for each contact.

    Only fast models are asked (`ModelCard.is_fast`), and no finite elements: `softfinger select`
    also knows these. The cost is that of a prediction of all these contacts, measured.

    Args:
        tolerance: of every chosen quantity, relative; positive and finite
        models: names of those allowed; default: all fast ones
        quantities: out of "a", "b", "indentation", "area", "peak_pressure", "max_torque"

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
            raise InputError("select", "quantities", quantity, ", ".join(QUANTITIES))
    if not quantities:
        raise InputError("select", "quantities", quantities, "at least one")
    fast = [card["name"] for card in _core.models() if card["is_fast"]]
    names = fast if models is None else [models] if isinstance(models, str) else list(models)
    for name in names:
        if name not in fast:
            raise InputError("select", "models", name, ", ".join(fast))
    if not names:
        raise InputError("select", "models", models, "at least one of " + ", ".join(fast))
    cost_s = {name: _cost_s(name, contacts) for name in names}
    bounds = {name: error_bound.of_contacts(contacts, name) for name in names}
    chosen = numpy.full(contacts.shape, "", dtype=object)
    bound = numpy.full(contacts.shape, numpy.inf)
    for name in sorted(names, key=cost_s.get, reverse=True):  # the cheapest one last
        worst = numpy.asarray(bounds[name].bound.largest(quantities))
        chosen = numpy.where(worst <= tolerance, name, chosen)
        bound = numpy.where(worst <= tolerance, worst, bound)
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
