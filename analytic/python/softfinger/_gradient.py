"""Derivatives of predictions."""

from __future__ import annotations

import dataclasses

from typing import Optional

from . import _core
from ._contacts import check_model, models_of, takes_contacts
from ._errors import NoAnswer
from ._predict import Prediction, predict
from ._result import Flags, Numbers, Result, result, shaped, shaped_rows


@result
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


@result
class PredictionWithGradient(Result):
    """A prediction, its derivatives, and the stiffnesses of the contact before it slips.

    Where `known` is false (no answer, two layers, or a model that solves the contact numerically)
    derivatives and stiffnesses of arrays are masked; for a single contact it is a NoAnswer.
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
    d_pressure_arm_m: Derivatives
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
def predict_with_gradient(contacts, model: Optional[str] = None) -> PredictionWithGradient:
    """A prediction, its exact derivatives (forward differentiation) and the contact's stiffnesses.

    `result.d_max_torque_Nm.thickness_m` is the derivative of the largest torque with respect to
    the layer's thickness. Takes four to five times a prediction's time; other threads run.

    Args:
        model: a name out of `models()`; default: the recommended one for each contact

    Returns:
        PredictionWithGradient, whose numbers have the shape to which the arguments broadcast
    """
    function = "predict_with_gradient"
    common, names = models_of(contacts, check_model(function, model))
    shape = contacts.shape
    prediction = predict.of_contacts(contacts, model)
    known, stuck, derivatives = _core.gradient(common, contacts.numbers)
    if not shape and not known:
        reason = (
            "it has no derivatives here: they are of one layer, and of models that are formulas"
        )
        raise NoAnswer(function, "model", names, reason)
    load_per_m = derivatives[
        _NUMBERS.index("d_indentation_m"), _VARIABLES.index("normal_force_N")
    ].copy()
    load_per_m[known] = 1 / load_per_m[known]

    return PredictionWithGradient(
        prediction,
        shaped(known, shape),
        *shaped_rows(load_per_m[None], shape, known),
        *shaped_rows(stuck, shape, known),
        *(Derivatives(*shaped_rows(number, shape, known)) for number in derivatives),
    )
