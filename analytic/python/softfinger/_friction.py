"""What a contact's friction can carry: tangential force and torque about the normal together.

A wrench is (force_x_N, force_y_N, torque_Nm) along the last axis of an array: x along the contact's
long axis, y along the short one, the torque about the normal. A twist is the sliding velocity
(velocity_x_m_per_s, velocity_y_m_per_s, angular_velocity_rad_per_s), of which only the direction
matters to dry friction. Arrays may have any shape (..., 3).
"""

from __future__ import annotations

import dataclasses
from typing import Optional

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import (
    NOT_NEGATIVE,
    POSITIVE,
    SHEAR_LAWS,
    Range,
    as_numbers,
    broadcast,
    check_range,
    friction_of,
    refuse_first,
)
from ._errors import InputError
from ._result import Flags, Numbers, Result, masked, result, shaped

_EXPONENT = Range(lambda n: (n > -1) & (n <= 1000), "above -1, at most 1000")


def _vectors(function, name, value, width):
    """Flat (n, width) and the shape without the last axis."""
    vectors = as_numbers(function, name, value)
    if vectors.ndim == 0 or vectors.shape[-1] != width:
        raise InputError(function, name, f"array of shape {vectors.shape}", f"shape (..., {width})")
    return numpy.ascontiguousarray(vectors.reshape(-1, width)), vectors.shape[:-1]


def _finite_vectors(function, name, value):
    vectors, shape = _vectors(function, name, value, 3)
    if not numpy.isfinite(vectors).all():
        raise InputError(function, name, vectors[~numpy.isfinite(vectors)][0], "finite numbers")
    return vectors, shape


def _single(function, name, value, allowed):
    number = as_numbers(function, name, value)
    if number.shape:
        raise InputError(function, name, f"array of shape {number.shape}", "one number")
    check_range(function, name, number, allowed)
    return float(number)


def _count(function, value):
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, numpy.integer))
        or not 0 < value <= 10**8
    ):
        raise InputError(function, "count", value, "a whole number, 1 to 100000000")
    return int(value)


def _direction(function, value):
    return _single(function, "direction_rad", value, Range(numpy.isfinite, "finite"))


@result
class FrictionEllipsoid(Result):
    """The limit f² + tau²/e_n² <= (mu P)² of a soft contact (Ciocarlie et al. 2007, eq. 1, 6).

    Under other shear laws than Coulomb's the largest force takes the place of mu P: see
    `of_shear_law`.

    An approximation of the exact limit surface, which lies inside it by up to 6 % (circle) to 11 %
    (a/b = 10) and, for forces along the long axis of a long ellipse, outside it by up to 5 %.

    Args:
        max_force_N: mu P, not negative; a number or an array
        eccentricity_m: e_n, the largest torque over it; not negative, broadcasts with max_force_N

    Raises:
        InputError: an argument is out of its range
    """

    max_force_N: Numbers
    eccentricity_m: Numbers

    def __post_init__(self):
        for name in ("max_force_N", "eccentricity_m"):
            value = getattr(self, name)
            if isinstance(value, numpy.ma.MaskedArray):  # of contacts without an answer
                value = value.compressed()
            value = as_numbers("FrictionEllipsoid", name, value)
            check_range("FrictionEllipsoid", name, value, NOT_NEGATIVE)

    @classmethod
    def of_shear_law(
        cls,
        a_m: ArrayLike,
        b_m: ArrayLike,
        exponent: ArrayLike,
        load_N: ArrayLike,
        shear_law: str = "coulomb",
        friction_coefficient: Optional[ArrayLike] = None,
        shear_strength_Pa: Optional[ArrayLike] = None,
    ) -> FrictionEllipsoid:
        """Of contacts with pressure p ~ (1 - x²/a² - y²/b²)^n under a shear law, in closed form: the
        integrals of its stress and of stress times radius over the ellipse, to 1e-13. Arrays
        broadcast.

        Args:
            a_m, b_m: semi-axes, a >= b > 0
            exponent: n, above -1, at most 1000
            load_N: P, not negative
            shear_law: "coulomb" mu p, "shear_strength" tau_0, "limited" min(mu p, tau_0),
                "adhesive_shear" tau_0 + mu p
            friction_coefficient: mu, not negative; of all laws but "shear_strength"
            shear_strength_Pa: tau_0, not negative; of all laws but "coulomb"

        Raises:
            InputError: an argument is out of its range, or not used by the law
        """
        function = "of_shear_law"
        friction, strength = friction_of(
            function, shear_law, friction_coefficient, shear_strength_Pa
        )
        arrays = {}
        for name, value, allowed in (
            ("a_m", a_m, POSITIVE),
            ("b_m", b_m, POSITIVE),
            ("exponent", exponent, _EXPONENT),
            ("load_N", load_N, NOT_NEGATIVE),
            ("friction_coefficient", friction, NOT_NEGATIVE),
            ("shear_strength_Pa", strength, NOT_NEGATIVE),
        ):
            arrays[name] = as_numbers(function, name, value)
            check_range(function, name, arrays[name], allowed)
        shape, flat = broadcast(function, arrays)
        ordered = (flat["b_m"] <= flat["a_m"]).reshape(shape)
        if not ordered.all():
            refuse_first(function, "b_m", flat["b_m"].reshape(shape), ordered, "at most a_m")
        force, arm = _core.friction_ellipsoids(SHEAR_LAWS.index(shear_law), *flat.values())
        return cls(shaped(force, shape), shaped(arm, shape))

    @property
    def max_torque_Nm(self) -> Numbers:
        return self.max_force_N * self.eccentricity_m

    def utilisation(self, wrench: ArrayLike) -> Numbers:
        """sqrt(f²/(mu P)² + tau²/(e_n mu P)²): below 1 the contact sticks.

        Infinite for a wrench that a vanishing limit cannot carry, 0 for no wrench at all; masked
        where the limit is.

        Args:
            wrench: (..., 3), finite, in N and N m; its leading axes broadcast with the ellipsoid's

        Returns:
            array of the leading shape, or a number
        """
        vectors, shape = _finite_vectors("utilisation", "wrench", wrench)
        try:
            force, arm, _ = numpy.broadcast_arrays(
                self.max_force_N, self.eccentricity_m, numpy.empty(shape)
            )
        except ValueError:
            raise InputError(
                "utilisation",
                "wrench",
                f"array of shape {shape + (3,)}",
                "leading axes that broadcast with the ellipsoid's",
            ) from None
        vectors = numpy.broadcast_to(vectors.reshape(shape + (3,)), force.shape + (3,))
        used = _core.ellipsoid_utilisation(
            numpy.ascontiguousarray(force, float).reshape(-1),
            numpy.ascontiguousarray(arm, float).reshape(-1),
            numpy.ascontiguousarray(vectors).reshape(-1, 3),
        )
        is_known = ~(numpy.isnan(force) | numpy.isnan(arm))
        return shaped(masked(used, is_known.reshape(-1)), force.shape)

    def sample_section(self, direction_rad: float, count: int) -> numpy.ndarray:
        """Points of the section by the plane of one direction of force, for plotting.

        Args:
            direction_rad: of the tangential force
            count: of points, evenly spaced in (f, tau/e_n), once round, starting at pure force

        Returns:
            (count, 3) wrenches
        """
        function = "sample_section"
        return _core.ellipsoid_section(
            _single(function, "max_force_N", self.max_force_N, NOT_NEGATIVE),
            _single(function, "eccentricity_m", self.eccentricity_m, NOT_NEGATIVE),
            _direction(function, direction_rad),
            _count(function, count),
        )


class _Surface(Result):
    """What the exact limit surfaces of a contact have in common."""

    @property
    def _core(self):
        raise NotImplementedError

    @property
    def eccentricity_m(self) -> float:
        """e_n, the largest torque over the largest force."""
        return self._core.eccentricity_m

    @property
    def max_torque_Nm(self) -> Numbers:
        return self.max_force_N * self.eccentricity_m

    def ellipsoid(self) -> FrictionEllipsoid:
        """The FrictionEllipsoid that touches this surface at pure force and at pure torque."""
        return FrictionEllipsoid(self.max_force_N, self.eccentricity_m)

    def wrench_for_twist(self, twist: ArrayLike) -> numpy.ndarray:
        """Points (..., 3) of the surface whose outward normals are the twists (..., 3).

        Zero for no twist at all.
        """
        vectors, shape = _finite_vectors("wrench_for_twist", "twist", twist)
        return self._core.wrench_for_twist(vectors).reshape(shape + (3,))

    def support(self, twist: ArrayLike) -> Numbers:
        """The largest power wrench . twist, in W, of all that can be carried; twist (..., 3)."""
        vectors, shape = _finite_vectors("support", "twist", twist)
        return shaped(self._core.support(vectors), shape)

    def utilisation(self, wrench: ArrayLike) -> Numbers:
        """By what factor wrenches (..., 3) exceed what can be carried: below 1 the contact sticks.

        Infinite for a wrench that a vanishing limit cannot carry, 0 for no wrench at all.
        """
        vectors, shape = _finite_vectors("utilisation", "wrench", wrench)
        return shaped(self._core.utilisation(vectors), shape)

    def contains(self, wrench: ArrayLike) -> Flags:
        """Whether wrenches (..., 3) can be carried: utilisation <= 1."""
        return self.utilisation(wrench) <= 1

    def project(self, wrench: ArrayLike) -> numpy.ndarray:
        """The nearest wrenches (..., 3) that can be carried, in the scaled space (f, tau/e_n)."""
        vectors, shape = _finite_vectors("project", "wrench", wrench)
        return self._core.project(vectors).reshape(shape + (3,))

    def sample(self, count: int) -> numpy.ndarray:
        """Wrenches (count, 3) spread evenly over the surface in the scaled space."""
        return self._core.sample(_count("sample", count))

    def sample_section(self, direction_rad: float, count: int) -> numpy.ndarray:
        """Points of the section by the plane of one direction of force, as FrictionEllipsoid's."""
        function = "sample_section"
        return self._core.sample_section(
            _direction(function, direction_rad), _count(function, count)
        )


@result
class LimitSurface(_Surface):
    """The exact force-torque limit surface of a contact with pressure p ~ (1 - x²/a² - y²/b²)^n in
    which every point slides with Coulomb friction against its own velocity (Howe, Cutkosky 1996).

    Wrenches are those that keep the slider moving; the friction on it is the negative. The error is
    below 1e-12 for a/b to 2500. A wrench takes 0.4 (circle) to 4 microseconds, a utilisation 10 to
    45. Other threads run meanwhile.

    Args:
        a_m, b_m: semi-axes, a >= b > 0
        exponent: n, above -1, at most 1000: 1/2 is Hertz, 1 Winkler, 2 the thin incompressible
            layer, 0 uniform pressure
        max_force_N: mu P, not negative

    Raises:
        InputError: an argument is out of its range
    """

    a_m: float
    b_m: float
    exponent: float
    max_force_N: float

    def __post_init__(self):
        function = "LimitSurface"
        for name, allowed in (
            ("a_m", POSITIVE),
            ("b_m", POSITIVE),
            ("exponent", _EXPONENT),
            ("max_force_N", NOT_NEGATIVE),
        ):
            object.__setattr__(self, name, _single(function, name, getattr(self, name), allowed))
        if self.b_m > self.a_m:
            raise InputError(function, "b_m", self.b_m, "at most a_m")

    @property
    def _core(self):
        return _core.LimitSurface(self.a_m, self.b_m, self.exponent, self.max_force_N)

    def wrench_for_center_of_rotation(self, center_m: ArrayLike) -> numpy.ndarray:
        """The same for a counter-clockwise turn about points (..., 2) of the contact plane in m.

        Infinite coordinates are translations: (inf, y) along -y, (x, inf) along +x.
        """
        function = "wrench_for_center_of_rotation"
        vectors, shape = _vectors(function, "center_m", center_m, 2)
        if numpy.isnan(vectors).any():
            raise InputError(function, "center_m", numpy.nan, "numbers, infinite ones included")
        return self._core.wrench_for_center_of_rotation(vectors).reshape(shape + (3,))


@result
class ShearSurface(_Surface):
    """The exact limit surface of the same contact under another shear law than Coulomb's: the
    LimitSurface with mu p replaced by the law's stress.

    Sums of LimitSurfaces for "shear_strength" and "adhesive_shear" (1e-12); "limited" is a pile of
    uniform discs, to 1e-9 in the scaled space, and takes up to a millisecond for a utilisation.
    Other threads run meanwhile.

    Args:
        a_m, b_m: semi-axes, a >= b > 0
        exponent: n of the pressure, above -1, at most 1000
        load_N: P, not negative
        shear_law: "coulomb" mu p, "shear_strength" tau_0, "limited" min(mu p, tau_0),
            "adhesive_shear" tau_0 + mu p
        friction_coefficient: mu, not negative; of all laws but "shear_strength"
        shear_strength_Pa: tau_0, not negative; of all laws but "coulomb"

    Raises:
        InputError: an argument is out of its range, or not used by the law
    """

    a_m: float
    b_m: float
    exponent: float
    load_N: float
    shear_law: str
    friction_coefficient: Optional[float] = None
    shear_strength_Pa: Optional[float] = None

    def __post_init__(self):
        function = "ShearSurface"
        friction_of(function, self.shear_law, self.friction_coefficient, self.shear_strength_Pa)
        for name, allowed in (
            ("a_m", POSITIVE),
            ("b_m", POSITIVE),
            ("exponent", _EXPONENT),
            ("load_N", NOT_NEGATIVE),
            ("friction_coefficient", NOT_NEGATIVE),
            ("shear_strength_Pa", NOT_NEGATIVE),
        ):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _single(function, name, value, allowed))
        if self.b_m > self.a_m:
            raise InputError(function, "b_m", self.b_m, "at most a_m")

    @property
    def _core(self):
        return _core.ShearSurface(
            SHEAR_LAWS.index(self.shear_law),
            self.a_m,
            self.b_m,
            self.exponent,
            self.load_N,
            self.friction_coefficient or 0.0,
            self.shear_strength_Pa or 0.0,
        )

    @property
    def max_force_N(self) -> float:
        """The largest force along the surface."""
        return self._core.max_force_N
