"""Contact ellipse, pressure and largest torque of a model."""

from __future__ import annotations

import dataclasses
import functools
from typing import Optional, Union

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import (
    ONE_CONTACT,
    SHEAR_LAWS,
    check_model,
    models_of,
    single_model,
    takes_contacts,
    takes_contacts_with_friction,
)
from ._result import Flags, Numbers, Result, Words, masked, of_fields, result, shaped
from ._errors import InputError, NoAnswer
from ._friction import FrictionEllipsoid, LimitSurface, ShearSurface


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
    knows_pressing_friction: bool  #: whether its answers have the friction that acts while pressing
    is_for_several_layers: bool  #: layers on both bodies; one layer has the answer of bonded_layer


def models() -> dict[str, ModelCard]:
    """The cards of all models, by name."""
    return {card["name"]: ModelCard(**card) for card in _core.models()}


@result
class Prediction(Result):
    """Contact ellipse and pressure, as pressed with friction where `pressing` says so. What friction
    carries at full slip is that of frictionless pressing: its direction has turned by then. Arrays of contacts are masked where the model has no answer; a
    single contact without one is a NoAnswer, which `predict` raises."""

    model: Words  #: that answered; an array where each contact got the recommended one
    has_answer: Flags  #: bool; `checks` tells why not
    a_m: Numbers  #: semi-axis along the contact's long axis, a >= b
    b_m: Numbers  #: semi-axis along the short axis
    indentation_m: Numbers  #: approach d of the two bodies, first touch = 0
    area_m2: Numbers  #: pi a b
    peak_pressure_Pa: Numbers
    pressing: Words  #: "coulomb", "stuck" or, for models that leave it out, "frictionless"
    pressure_arm_m: Numbers  #: (int p r dA)/P as pressed
    frictionless_a_m: Numbers  #: semi-axes of the contact that is pressed without friction
    frictionless_b_m: Numbers
    torque_arm_exact_m: Numbers  #: (int p r dA)/P of that one, the e_n of the friction ellipsoid
    torque_arm_paper_m: Numbers  #: the arm of the circle of radius sqrt(ab) (Ciocarlie et al. 2007)
    max_force_N: Numbers  #: by the shear law; Coulomb's: mu P
    max_torque_Nm: Numbers  #: by the shear law; Coulomb's: mu P times the exact arm
    eccentricity_m: Numbers  #: largest torque over largest force
    normal_force_N: Numbers  #: as asked
    shear_law: str  #: as asked
    friction_coefficient: Numbers  #: as asked; 0 where the law has none
    shear_strength_Pa: Numbers  #: as asked; 0 where the law has none

    def friction_ellipsoid(self) -> FrictionEllipsoid:
        """The FrictionEllipsoid with this largest force and torque."""
        return FrictionEllipsoid(self.max_force_N, self.eccentricity_m)

    def limit_surface(self) -> Union[LimitSurface, ShearSurface]:
        """The exact limit surface of a single contact: a LimitSurface under Coulomb's law, else a
        ShearSurface.

        Its pressure is p ~ (1 - x²/a² - y²/b²)^n on the ellipse without friction, with the n that has this torque
        arm.

        Raises:
            InputError: for arrays
        """
        if numpy.shape(self.a_m):
            raise InputError("limit_surface", "shape", numpy.shape(self.a_m), "one contact")
        ellipse = (self.frictionless_a_m, self.frictionless_b_m)
        (exponent,) = _core.equivalent_exponents(
            *(numpy.array([x]) for x in (*ellipse, self.torque_arm_exact_m))
        )
        if self.shear_law == "coulomb":
            return LimitSurface(*ellipse, exponent, self.max_force_N)
        return ShearSurface(
            *ellipse,
            exponent,
            self.normal_force_N,
            self.shear_law,
            None if self.shear_law == "shear_strength" else self.friction_coefficient,
            self.shear_strength_Pa,
        )


def _is_normal(values):
    limits = numpy.finfo(numpy.float64)
    return (values >= limits.tiny) & (values <= limits.max)


def _predict_at_once(arguments):
    fields = ONE_CONTACT.predict(arguments)
    return None if fields is None else of_fields(Prediction, fields)


@functools.partial(takes_contacts_with_friction, at_once=_predict_at_once)
def predict(contacts, model: Optional[str] = None) -> Prediction:
    """Contact ellipse, indentation, pressure and largest torque of elastic layers on rigid cores.

    Answers arrays by the C++ library's predict_batch, with the same bits; bonded_layer and
    fingertip_layer take a fifth of a microsecond per contact, and a contact by itself a few
    microseconds. Other threads run during arrays.

    Args:
        model: a name out of `models()`, whose card names the equations and their source; default:
            the recommended model for each contact, fingertip_layer for fingers like those that it
            was fitted to, else bonded_layer

    Returns:
        Prediction, whose numbers have the shape to which the arguments broadcast
    """
    common, names = models_of(contacts, check_model("predict", model))
    numbers = _core.predict(common, contacts.numbers)
    numbers["area_m2"] = numpy.pi * numbers["a_m"] * numbers["b_m"]
    load, friction = (contacts.numbers[x] for x in ("normal_force_N", "friction_coefficient"))
    strength = contacts.numbers.get("shear_strength_Pa", numpy.zeros_like(friction))
    law = contacts.numbers["shear_law"]
    with numpy.errstate(over="ignore", under="ignore"):
        force = friction * load
        torque = force * numbers["torque_arm_exact_m"]
    # As PressureModel::predict has it, which knows the friction coefficient: what a double cannot
    # hold is no answer.
    is_lost = (friction > 0) & ~(_is_normal(force) & _is_normal(torque))
    has_answer = (numbers["a_m"] > 0) & ~is_lost
    shape = contacts.shape
    if not shape and not has_answer:
        raise no_answer("predict", contacts, names)
    if law == "coulomb":
        arm = numbers["torque_arm_exact_m"].copy()
    else:
        ellipse = (numbers["frictionless_a_m"], numbers["frictionless_b_m"])
        exponent = _core.equivalent_exponents(*ellipse, numbers["torque_arm_exact_m"])
        force, arm = _core.friction_ellipsoids(
            SHEAR_LAWS.index(law), *ellipse, exponent, load, friction, strength
        )
        torque = force * arm
    numbers.update(max_force_N=force, max_torque_Nm=torque, eccentricity_m=arm)
    asked = dict(normal_force_N=load, friction_coefficient=friction, shear_strength_Pa=strength)
    return Prediction(
        names,
        shaped(has_answer, shape),
        shear_law=law,
        pressing=_pressings(contacts, names),
        **{name: shaped(masked(x, has_answer), shape) for name, x in numbers.items()},
        **{name: shaped(x, shape) for name, x in asked.items()},
    )


_KNOWS_PRESSING_FRICTION = {
    card["name"]: card["knows_pressing_friction"] for card in _core.models()
}


def _pressings(contacts, names):
    """The friction that each answer is pressed with. The recommended models all know it."""
    name, friction = (contacts.numbers[x] for x in ("pressing", "pressing_friction_coefficient"))
    if isinstance(names, str) and not _KNOWS_PRESSING_FRICTION[names]:
        friction = numpy.zeros_like(friction)
    return shaped(numpy.where(friction > 0, name, "frictionless").astype(object), contacts.shape)


def no_answer(function, contacts, model):
    """The NoAnswer of one contact, with the model's reasons."""
    failing = [check.message for check in _checks(contacts, model) if not check.holds]
    reasons = [message.removeprefix("no answer: ") for message in failing]
    if model != "bonded_layer":
        reasons.append("ask another model, for instance bonded_layer")
    return NoAnswer(function, "model", model, "; ".join(reasons))


@dataclasses.dataclass(frozen=True)
class Check:
    """One assumption of a model, measured on the contact at hand."""

    name: str
    value: float
    limit: float
    holds: bool
    holds_below: bool  #: whether it holds while value <= limit, else while value >= limit
    message: str  #: what it means when it does not hold


def _checks(contacts, model):
    return tuple(Check(*check) for check in _core.checks(model, contacts.numbers))


@takes_contacts
def checks(contacts, model: Optional[str] = None) -> tuple[Check, ...]:
    """Which assumptions of a model hold for one contact, and why it has no answer if it has none.

    Args:
        model: a name out of `models()`; default: the recommended one

    Returns:
        tuple of Check
    """
    contacts.require_single("checks", "call it for each")
    return _checks(contacts, single_model("checks", contacts, model))


@takes_contacts
def pressure_Pa(contacts, x_m: ArrayLike, y_m: ArrayLike, model: Optional[str] = None) -> Numbers:
    """The pressure of one contact at points of the contact plane, in Pa; 0 outside of the contact.

    Args:
        x_m, y_m: arrays that broadcast, along the contact's long and short axis from its centre
        model: a name out of `models()`; default: the recommended one

    Returns:
        array of the shape to which x_m and y_m broadcast

    Raises:
        NoAnswer: the model has none for this contact
    """
    contacts.require_single("pressure_Pa", "call it for each")
    model = single_model("pressure_Pa", contacts, model)
    x, y = numpy.broadcast_arrays(numpy.asarray(x_m, float), numpy.asarray(y_m, float))
    points = numpy.stack([x.reshape(-1), y.reshape(-1)], axis=1)
    pressure = _core.pressure_Pa(model, contacts.numbers, points)
    if pressure is None:
        raise no_answer("pressure_Pa", contacts, model)
    return shaped(pressure, x.shape)
