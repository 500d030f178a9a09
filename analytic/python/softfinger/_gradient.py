"""Derivatives of predictions."""

from __future__ import annotations

import dataclasses

from . import _core
from ._contacts import check_model, takes_contacts
from ._result import Flags, Numbers, Result, shaped
from ._predict import Prediction, predict


@dataclasses.dataclass(frozen=True, eq=False)
class Derivatives(Result):
    """Derivatives of one number with respect to each number of the contact, in SI units.

    R' and R'' are varied with the finger's own curvature kept, and the other way round.
    """

    normal_force_N: Numbers
    youngs_modulus_Pa: Numbers
    poisson_ratio: Numbers  #: at 1/2 that from below
    thickness_m: Numbers
    radius_major_m: Numbers
    radius_minor_m: Numbers  #: at R' = R'' that of a longer R' and a shorter R''
    finger_xx_per_m: Numbers
    finger_yy_per_m: Numbers
    finger_xy_per_m: Numbers
    friction_coefficient: Numbers


@dataclasses.dataclass(frozen=True, eq=False)
class PredictionWithGradient(Result):
    """A prediction, its derivatives, and the stiffnesses of the contact before it slips.

    Where `known` is false (no answer, two layers, or a model that solves the contact numerically)
    derivatives and stiffnesses are zero.
    """

    prediction: Prediction
    known: Flags  #: bool
    normal_stiffness_N_per_m: Numbers  #: dP/dd at the load
    torsional_stiffness_Nm_per_rad: Numbers
    tangential_stiffness_x_N_per_m: Numbers  #: along the contact's long axis
    tangential_stiffness_y_N_per_m: Numbers
    d_a_m: Derivatives
    d_b_m: Derivatives
    d_indentation_m: Derivatives
    d_area_m2: Derivatives
    d_peak_pressure_Pa: Derivatives
    d_torque_arm_exact_m: Derivatives
    d_torque_arm_paper_m: Derivatives
    d_max_torque_Nm: Derivatives
    d_torsional_stiffness_Nm_per_rad: Derivatives
    d_tangential_stiffness_x_N_per_m: Derivatives
    d_tangential_stiffness_y_N_per_m: Derivatives


# In the order of bindings/gradient.cc.
_NUMBERS = [f.name for f in dataclasses.fields(PredictionWithGradient) if f.name.startswith("d_")]
_VARIABLES = [f.name for f in dataclasses.fields(Derivatives)]


@takes_contacts
def predict_with_gradient(contacts, model: str = "fingertip_layer") -> PredictionWithGradient:
    """A prediction, its exact derivatives (forward differentiation) and the contact's stiffnesses.

    `result.d_max_torque_Nm.thickness_m` is the derivative of the largest torque with respect to
    the layer's thickness. Takes four to five times a prediction's time; other threads run.

    Args:
        model: a name out of `models()`

    Returns:
        PredictionWithGradient, whose numbers have the shape to which the arguments broadcast
    """
    check_model("predict_with_gradient", model)
    shape = contacts.shape
    known, stuck, derivatives = _core.gradient(model, contacts.numbers)
    load_per_m = derivatives[
        _NUMBERS.index("d_indentation_m"), _VARIABLES.index("normal_force_N")
    ].copy()
    load_per_m[known] = 1 / load_per_m[known]
    return PredictionWithGradient(
        predict.of_contacts(contacts, model),
        shaped(known, shape),
        shaped(load_per_m, shape),
        *(shaped(stiffness, shape) for stiffness in stuck),
        *(Derivatives(*(shaped(by, shape) for by in number)) for number in derivatives),
    )
