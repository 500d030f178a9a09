"""Flat pads on flat faces: contact without an ellipse."""

from __future__ import annotations

from typing import Sequence

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import NOT_NEGATIVE, POISSON, POSITIVE, as_numbers, check_range
from ._errors import InputError, NoAnswer
from ._friction import FrictionEllipsoid
from ._names import choices
from ._result import Flags, Numbers, Result, masked, result, shaped

PAD_MODELS = ("pad_layer", "pad_uniform")
PRESSINGS = ("stuck", "frictionless")
_RANGES = {
    "normal_force_N": POSITIVE,
    "youngs_modulus_Pa": POSITIVE,
    "poisson_ratio": POISSON,
    "thickness_m": POSITIVE,
    "friction_coefficient": NOT_NEGATIVE,
}


@result
class PadPrediction(Result):
    """What a flat pad holds. Arrays are masked where the model has no answer. Numbers about x and y
    are those of moments about these axes."""

    has_answer: Flags  #: bool
    indentation_m: Numbers  #: approach d of the two faces
    normal_stiffness_N_per_m: Numbers  #: dP/dd
    peak_pressure_Pa: Numbers  #: within 0.95 of the outline: a stuck rim has no largest pressure
    pressure_arm_m: Numbers  #: (int p r dA)/P as pressed
    eccentricity_m: Numbers  #: e_n: the same without friction, to which a twist to full slip leads
    tilt_stiffness_x_Nm_per_rad: Numbers
    tilt_stiffness_y_Nm_per_rad: Numbers
    tilt_limit_x_Nm: Numbers  #: the largest moment without lift-off
    tilt_limit_y_Nm: Numbers
    torsional_stiffness_Nm_per_rad: Numbers  #: of the stuck pad
    tangential_stiffness_x_N_per_m: Numbers  #: of the stuck pad, its faces kept parallel
    tangential_stiffness_y_N_per_m: Numbers
    torque_bound: Numbers  #: relative, against finite elements of the pad; infinite: not known
    max_force_N: Numbers  #: mu P
    max_torque_Nm: Numbers  #: mu P e_n

    def friction_ellipsoid(self) -> FrictionEllipsoid:
        """The FrictionEllipsoid with this largest force and torque."""
        return FrictionEllipsoid(self.max_force_N, self.eccentricity_m)


class FlatPad:
    """A flat elastic pad on a rigid backing, pressed on a rigid plane or face, over the outline of
    the contact. Made by `rectangle`, `disc` or `polygon`, which takes some ten milliseconds; each
    answer takes a microsecond.

        pad = softfinger.FlatPad.rectangle(22e-3, 37.5e-3)
        pad.predict(normal_force_N=20, youngs_modulus_Pa=800e3, poisson_ratio=0.49,
                    thickness_m=3e-3, friction_coefficient=0.7).eccentricity_m
    """

    def __init__(self, *_, **__):
        raise TypeError("FlatPad is made by FlatPad.rectangle, FlatPad.disc or FlatPad.polygon")

    @classmethod
    def rectangle(cls, length_m: float, width_m: float, corner_radius_m: float = 0.0) -> FlatPad:
        """A rectangle around the origin, `length_m` along x.

        Raises:
            InputError: a length that is not positive, or a radius above half the shorter side
        """
        return cls._of(_core.PadShape.rectangle(length_m, width_m, corner_radius_m))

    @classmethod
    def disc(cls, diameter_m: float) -> FlatPad:
        """A disc around the origin.

        Raises:
            InputError: a diameter that is not positive
        """
        diameter = as_numbers("FlatPad.disc", "diameter_m", diameter_m)
        check_range("FlatPad.disc", "diameter_m", diameter, POSITIVE)
        return cls._of(_core.PadShape.disc(float(diameter)))

    @classmethod
    def polygon(cls, points_m: Sequence[Sequence[float]]) -> FlatPad:
        """A convex polygon by its corners, in either direction.

        Raises:
            InputError: an outline that crosses itself, is not convex or has no area
        """
        points = as_numbers("FlatPad.polygon", "points_m", points_m)
        if points.ndim != 2 or points.shape[1] != 2 or not numpy.isfinite(points).all():
            raise InputError("FlatPad.polygon", "points_m", None, "n points (x, y), finite")
        return cls._of(_core.PadShape.polygon(points))

    @classmethod
    def _of(cls, shape):
        made = object.__new__(cls)
        made._shape = shape
        return made

    @property
    def area_m2(self) -> float:
        """Area of the outline."""
        return self._shape.area_m2

    @property
    def vertices_m(self) -> numpy.ndarray:
        """Corners of the outline, (n, 2), counter-clockwise."""
        return self._shape.vertices_m

    def predict(
        self,
        normal_force_N: ArrayLike,
        youngs_modulus_Pa: ArrayLike,
        poisson_ratio: ArrayLike,
        thickness_m: ArrayLike,
        friction_coefficient: ArrayLike,
        model: str = "pad_layer",
        pressing: str = "stuck",
    ) -> PadPrediction:
        """Stiffness, pressure, tilting and largest torque of the pad, loaded in its middle.

        Args:
            normal_force_N: load P, positive
            youngs_modulus_Pa: E, positive
            poisson_ratio: nu, 0 to 0.5
            thickness_m: h, positive
            friction_coefficient: mu, not negative
            model: "pad_layer" (Gent, Lindley 1959; Chalhoub, Kelly 1990, with the rim's part) or
                "pad_uniform"
            pressing: "stuck", as rubber is, or "frictionless"

        Raises:
            InputError: an argument is out of its range
            NoAnswer: a single pad of which the model has none
        """
        function = "FlatPad.predict"
        if model not in PAD_MODELS:
            raise InputError(function, "model", model, choices(model, PAD_MODELS))
        if pressing not in PRESSINGS:
            raise InputError(function, "pressing", pressing, choices(pressing, PRESSINGS))
        given = (
            normal_force_N,
            youngs_modulus_Pa,
            poisson_ratio,
            thickness_m,
            friction_coefficient,
        )
        arrays = [as_numbers(function, name, value) for name, value in zip(_RANGES, given)]
        for (name, allowed), values in zip(_RANGES.items(), arrays):
            check_range(function, name, values, allowed)
        try:
            arrays = numpy.broadcast_arrays(*arrays)
        except ValueError:
            raise InputError(function, "shapes", None, "shapes that broadcast") from None
        shape = arrays[0].shape
        *columns, friction = (numpy.ravel(array) for array in arrays)
        fields = self._shape.predict(model, pressing == "stuck", *columns)
        known = fields.pop("has_answer")
        if not shape and not known.item():
            raise NoAnswer(function, "model", model, "the numbers overflow, or nothing is pressed")
        fields["max_force_N"] = friction * columns[0]
        fields["max_torque_Nm"] = fields["max_force_N"] * fields["eccentricity_m"]
        return PadPrediction(
            has_answer=shaped(known, shape),
            **{name: shaped(masked(values, known), shape) for name, values in fields.items()},
        )
