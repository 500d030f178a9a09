"""Contact ellipse, pressure and largest torque of a model."""

from __future__ import annotations

import dataclasses

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import check_model, takes_contacts
from ._result import Flags, Numbers, Result, shaped
from ._errors import InputError
from ._friction import FrictionEllipsoid, LimitSurface


@dataclasses.dataclass(frozen=True)
class ModelCard:
    """What to know of a model before using it, in words."""

    name: str
    title: str
    assumptions: str
    equations: str
    source: str
    validity: str
    cost: str
    is_fast: bool  #: microseconds, no allocation
    has_finite_strain: bool  #: of large deformation


def models() -> dict[str, ModelCard]:
    """The cards of all models, by name."""
    return {card["name"]: ModelCard(**card) for card in _core.models()}


@dataclasses.dataclass(frozen=True, eq=False)
class Prediction(Result):
    """Contact ellipse and pressure of one model. All numbers are zero where it has no answer."""

    model: str
    has_answer: Flags  #: bool; `checks` tells why not
    a_m: Numbers  #: semi-axis along the contact's long axis, a >= b
    b_m: Numbers  #: semi-axis along the short axis
    indentation_m: Numbers  #: approach d of the two bodies, first touch = 0
    area_m2: Numbers  #: pi a b
    peak_pressure_Pa: Numbers
    torque_arm_exact_m: Numbers  #: (int p r dA)/P, the e_n of the friction ellipsoid
    torque_arm_paper_m: Numbers  #: that of the circle of radius sqrt(ab) (Ciocarlie et al. 2007)
    max_force_N: Numbers  #: mu P
    max_torque_Nm: Numbers  #: mu P times the exact arm

    def friction_ellipsoid(self) -> FrictionEllipsoid:
        """The FrictionEllipsoid with this largest force and torque."""
        return FrictionEllipsoid(self.max_force_N, self.torque_arm_exact_m)

    def limit_surface(self) -> LimitSurface:
        """The exact LimitSurface of a single contact.

        Its pressure is p ~ (1 - x²/a² - y²/b²)^n on this ellipse, with the n that has this torque
        arm.

        Raises:
            InputError: for arrays, and without an answer
        """
        if numpy.shape(self.a_m):
            raise InputError("limit_surface", "shape", numpy.shape(self.a_m), "one contact")
        if not self.has_answer:
            raise InputError("limit_surface", "has_answer", False, "a contact with an answer")
        exponent = _core.equivalent_exponent(self.a_m, self.b_m, self.torque_arm_exact_m)
        return LimitSurface(self.a_m, self.b_m, exponent, self.max_force_N)


def _is_normal(values):
    limits = numpy.finfo(numpy.float64)
    return (values >= limits.tiny) & (values <= limits.max)


@takes_contacts
def predict(contacts, model: str = "fingertip_layer") -> Prediction:
    """Contact ellipse, indentation, pressure and largest torque of elastic layers on rigid cores.

    Answers arrays by the C++ library's predict_batch, with the same bits; bonded_layer and
    fingertip_layer take a fifth of a microsecond per contact. Other threads run meanwhile.

    Args:
        model: a name out of `models()`; its card names the equations and their source

    Returns:
        Prediction, whose numbers have the shape to which the arguments broadcast
    """
    check_model("predict", model)
    numbers = _core.predict(model, contacts.numbers)
    numbers["area_m2"] = numpy.pi * numbers["a_m"] * numbers["b_m"]
    friction = contacts.numbers["friction_coefficient"]
    with numpy.errstate(over="ignore", under="ignore"):
        numbers["max_force_N"] = friction * contacts.numbers["normal_force_N"]
        numbers["max_torque_Nm"] = numbers["max_force_N"] * numbers["torque_arm_exact_m"]
    # As PressureModel::predict has it, which knows the friction coefficient: what a double cannot
    # hold is no answer.
    is_lost = (friction > 0) & ~(
        _is_normal(numbers["max_force_N"]) & _is_normal(numbers["max_torque_Nm"])
    )
    if is_lost.any():
        for values in numbers.values():
            values[is_lost] = 0
    numbers["has_answer"] = numbers["a_m"] > 0
    return Prediction(model, **{name: shaped(x, contacts.shape) for name, x in numbers.items()})


@dataclasses.dataclass(frozen=True)
class Check:
    """One assumption of a model, measured on the contact at hand."""

    name: str
    value: float
    limit: float
    holds: bool
    holds_below: bool  #: whether it holds while value <= limit, else while value >= limit
    message: str  #: what it means when it does not hold


@takes_contacts
def checks(contacts, model: str = "fingertip_layer") -> tuple[Check, ...]:
    """Which assumptions of a model hold for one contact, and why it has no answer if it has none.

    Args:
        model: a name out of `models()`

    Returns:
        tuple of Check
    """
    check_model("checks", model)
    contacts.require_single("checks", "call it for each")
    return tuple(Check(*check) for check in _core.checks(model, contacts.numbers))


@takes_contacts
def pressure_Pa(
    contacts, x_m: ArrayLike, y_m: ArrayLike, model: str = "fingertip_layer"
) -> Numbers:
    """The pressure of one contact at points of the contact plane, in Pa; 0 outside of the contact.

    Args:
        x_m, y_m: arrays that broadcast, along the contact's long and short axis from its centre
        model: a name out of `models()`

    Returns:
        array of the shape to which x_m and y_m broadcast
    """
    check_model("pressure_Pa", model)
    contacts.require_single("pressure_Pa", "call it for each")
    x, y = numpy.broadcast_arrays(numpy.asarray(x_m, float), numpy.asarray(y_m, float))
    points = numpy.stack([x.reshape(-1), y.reshape(-1)], axis=1)
    return shaped(_core.pressure_Pa(model, contacts.numbers, points), x.shape)
