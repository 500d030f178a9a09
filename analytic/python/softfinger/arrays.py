"""The fast models on arrays of any library that has the array API: numpy, torch and others.

    import torch
    from softfinger import arrays
    load_N = torch.tensor([0.5, 2.0, 4.0], dtype=torch.float64, requires_grad=True)
    contact = arrays.fingertip_layer(
        normal_force_N=load_N, youngs_modulus_Pa=300e3, poisson_ratio=0.45, thickness_m=2e-3,
        radius_major_m=20e-3, radius_minor_m=5e-3, friction_coefficient=0.8)
    contact.max_torque_Nm.sum().backward()

The C++ library writes down its own formulas as a list of steps (bindings/traced.h), and this module
repeats the steps on arrays: there is no second copy of a formula or of a table. In double precision
the numbers are those of the compiled part to 1e-12. Derivatives are those of
`predict_with_gradient` to 1e-10 of the number over the variable: where the terms of a derivative
cancel, as that by the thickness of a thick layer, it keeps fewer digits of its own in both.

All arguments are numbers or arrays in SI units that broadcast. Results are arrays of the library,
on the device and of the precision of the arguments; numpy's of double precision where there are
only numbers. numpy and torch are tested. Another library needs the array API with indexing by
arrays of whole numbers, as its version 2024.12 has it.

No value of an array raises an error, because an accelerator would have to be waited for. A contact
with an argument that is NaN or out of its range, or of which the model has no answer, is NaN in
every number and infinite in every bound. The other contacts and their derivatives stay as they are;
derivatives by an argument that is out of its range are zero.
"""

from __future__ import annotations

import functools
import math
import operator
import sys
from typing import Any, NamedTuple

import numpy

from . import _core
from ._contacts import ARRAYS, AT_LEAST_ONE, POISSON, POSITIVE, as_numbers, check_range
from ._contacts import PRESSINGS as _PRESSINGS
from ._errors import InputError
from ._names import choices, suggests_keywords
from ._pads import PRESSINGS, FlatPad

__all__ = [
    "Bounds",
    "Contact",
    "Pad",
    "Sample",
    "StuckStiffness",
    "bonded_layer",
    "error_bound",
    "fingertip_layer",
    "pad_layer",
    "sample",
    "stuck_stiffness",
    "utilisation",
]

_RANGES = {number.name: number.range for number in ARRAYS}
#: Inputs of the traced contacts, in the order of bindings/arrays.cc.
_INPUTS = (
    "normal_force_N",
    "youngs_modulus_Pa",
    "poisson_ratio",
    "thickness_m",
    "radius_major_m",
    "radius_minor_m",
    "finger_xx_per_m",
    "finger_yy_per_m",
    "finger_xy_per_m",
)
_TABLES = _core.arrays.tables()


def _is_foreign(value):
    """Whether it is an array of another library than numpy."""
    is_array = hasattr(value, "dtype") and hasattr(value, "shape")
    return is_array and not isinstance(value, (numpy.ndarray, numpy.generic))


class _Library:
    """An array library, with the precision and the device of the arguments of a call."""

    def __init__(self, function, arguments):
        self.of, self.device = numpy, {}
        foreign = {name: x for name, x in arguments.items() if _is_foreign(x)}
        if foreign:
            first = next(iter(foreign.values()))
            if hasattr(first, "__array_namespace__"):
                self.of = first.__array_namespace__()
            else:  # torch: its module has what is used here, under the same names
                self.of = sys.modules[type(first).__module__.partition(".")[0]]
            self.device = {"device": first.device} if hasattr(first, "device") else {}
        self.is_processor = self.of is numpy or str(self.device.get("device")) == "cpu"
        single, double = self.of.float32, self.of.float64
        for name, x in foreign.items():
            if x.dtype not in (single, double):
                raise InputError(function, name, str(x.dtype), "an array of float32 or float64")
        types = {x.dtype for x in (foreign or arguments).values() if hasattr(x, "dtype")}
        self.dtype = single if types and all(one == single for one in types) else double

    def array(self, value):
        """An array of this library. Those that are of it keep the history of their derivatives."""
        if not _is_foreign(value):
            return self.of.asarray(value, dtype=self.dtype, **self.device)
        return value if value.dtype == self.dtype else value * self.array(1.0)

    def where(self, condition, x, y):
        return self.of.where(condition, self.array(x), self.array(y))

    def at_most(self, x, most):
        return self.where(x > most, most, x)

    def whole(self, x, most):
        """Rounded down to 0..most, as a number and as an index. NaN gives 0."""
        x = self.where(x > 0, x, 0.0)
        x = self.of.floor(self.where(x < most, x, float(most)))
        return x, self.of.asarray(x, dtype=self.of.int64, **self.device)


# The operations of bindings/traced.h. Each returns its value, and a function that carries the slope
# of one of its operands on.


def _multiply(library, number, x, y):
    return x * y, lambda operand, slope: (y, x)[operand] * slope


def _divide(library, number, x, y):
    value = x / y
    return value, lambda operand, slope: (-value if operand else 1.0) * slope / y


def _exp(library, number, x):
    value = library.of.exp(x)
    return value, lambda _, slope: value * slope


def _sqrt(library, number, x):
    value = library.of.sqrt(x)
    return value, lambda _, slope: 0.5 / value * slope


def _choice(library, x, y, is_first):
    value = library.where(is_first, x, y)
    return value, lambda operand, slope: (
        library.where(is_first, 0.0, slope) if operand else library.where(is_first, slope, 0.0)
    )


def _polynomials(library, table, x):
    terms = library.array(_TABLES["polynomials"][int(table)])  # [piece, power, function]
    count, length = terms.shape[0], _TABLES["piece_length"]
    place = library.at_most(x, count * length) * (1 / length)
    piece, index = library.whole(place, count - 1)
    taken, t = terms[index], (2 * (place - piece) - 1)[..., None]
    value, by_t = taken[..., -1, :], 0.0
    for power in range(terms.shape[1] - 2, -1, -1):
        by_t = by_t * t + value
        value = value * t + taken[..., power, :]
    return value, by_t * (2 / length)


def _spline_weights(library, x, ends, knots):
    """The first of four coefficients, their weights, and the slopes of these (SplineWeights)."""
    per_knot = (knots - 1) / (ends[1] - ends[0])
    t = (x - ends[0]) * per_knot
    first, index = library.whole(t, knots - 2)
    f = t - first
    g = 1 - f
    weights = (
        g * g * g * (1 / 6),
        2 / 3 - f * f * (1 - 0.5 * f),
        2 / 3 - g * g * (1 - 0.5 * g),
        f * f * f * (1 / 6),
    )
    slopes = (-0.5 * g * g, -f * (2 - 1.5 * f), g * (2 - 1.5 * g), 0.5 * f * f)
    return index, weights, tuple(slope * per_knot for slope in slopes)


def _spline_rows(table):
    """Four sizes that follow each other as one row, because they are taken together."""
    windows = [table[:, :, k : table.shape[2] - 3 + k] for k in range(4)]
    return numpy.concatenate(windows, axis=3).reshape(-1, 4 * table.shape[3])


_SPLINE_ROWS = _spline_rows(_TABLES["spline"])


def _spline(library, number, log_size, compressibility, elongation):
    softs, ratios, sizes, quantities = _TABLES["spline"].shape
    # Longer ellipses get the corrections of the longest in the table.
    elongation = library.at_most(elongation, _TABLES["spline_ends"][2][1])
    size, soft, ratio = (
        _spline_weights(library, x, ends, count - 2)
        for x, ends, count in zip(
            (log_size, compressibility, elongation), _TABLES["spline_ends"], (sizes, softs, ratios)
        )
    )
    starts = sizes - 3
    start = (soft[0] * ratios + ratio[0]) * starts + size[0]
    around = [(i * ratios + j) * starts for i in range(4) for j in range(4)]
    around = library.of.asarray(around, dtype=library.of.int64, **library.device)
    rows = library.array(_SPLINE_ROWS)
    taken = rows[start[..., None] + around]  # [.., 16 rows, size and quantity]

    def weighted(weights, rows):
        return (library.of.stack(weights, axis=-1)[..., None, :] @ rows)[..., 0, :]

    def summed(size, soft, ratio):
        rows = weighted([i * j for i in soft for j in ratio], taken)
        return weighted(size, library.of.reshape(rows, (*rows.shape[:-1], 4, quantities)))

    weights, slopes = zip(size[1:], soft[1:], ratio[1:])
    return summed(*weights), lambda operand, slope: slope[..., None] * summed(
        *(slopes[n] if n == operand else weights[n] for n in range(3))
    )


def _polynomials_with_slope(library, table, x):
    value, by_x = _polynomials(library, table, x)
    return value, lambda _, slope: by_x * slope[..., None]


_OPERATIONS = {
    "number": lambda library, number: (number, None),
    "add": lambda library, number, x, y: (x + y, lambda _, slope: slope),
    "subtract": lambda library, number, x, y: (x - y, lambda n, slope: -slope if n else slope),
    "multiply": _multiply,
    "divide": _divide,
    "exp": _exp,
    "log": lambda library, number, x: (library.of.log(x), lambda _, slope: slope / x),
    "sqrt": _sqrt,
    "absolute": lambda library, number, x: (library.of.abs(x), None),
    "power": lambda library, number, x, y: (x**y, None),
    "larger": lambda library, number, x, y: _choice(library, x, y, x > y),
    "smaller": lambda library, number, x, y: _choice(library, x, y, x < y),
    "polynomials": _polynomials_with_slope,
    "polynomial_slopes": lambda library, number, x: (_polynomials(library, number, x)[1], None),
    "spline": _spline,
    "item": lambda library, number, x: (
        x[..., int(number)],
        lambda _, slope: slope[..., int(number)],
    ),
}


class _Program(NamedTuple):
    """The steps of a model: operation, places of the operands, number, places that are not needed
    after."""

    steps: list
    wanted: list

    @classmethod
    def of(cls, traced):
        steps, wanted = traced
        last_use = {i: place for place, (_, operands, _) in enumerate(steps) for i in operands}
        last_use.update(dict.fromkeys(wanted, len(steps)))
        done = [
            [i for i in set(x) if last_use[i] == place] for place, (_, x, _) in enumerate(steps)
        ]
        return cls([(*step, unneeded) for step, unneeded in zip(steps, done)], wanted)


_program = functools.lru_cache(
    lambda name, *choice: _Program.of(getattr(_core.arrays, name)(*choice))
)

#: So many contacts stay in a processor's cache from step to step.
_BLOCK = 8192


def _replay(library, program, inputs, variable=None):
    """Repeats the steps of a model.

    Args:
        variable: index of the input by which derivatives are wanted, if any

    Returns:
        the wanted numbers and, if wanted, their derivatives
    """
    of, shape = library.of, numpy.broadcast_shapes(*(tuple(x.shape) for x in inputs))
    count = math.prod(shape)
    if library.is_processor and count > _BLOCK:
        flat = [of.reshape(of.broadcast_to(x, shape), (count,)) for x in inputs]
        blocks = [
            _replay(library, program, [x[i : i + _BLOCK] for x in flat], variable)
            for i in range(0, count, _BLOCK)
        ]
        joined = getattr(of, "concat", numpy.concatenate)  # numpy before 2 has the longer name
        return tuple(
            [None if x[0] is None else of.reshape(joined(x), shape) for x in zip(*kind)]
            for kind in zip(*blocks)
        )
    values, slopes = [None] * len(program.steps), [None] * len(program.steps)
    with numpy.errstate(all="ignore"):  # what overflows has no answer, which is seen at the end
        for place, (operation, operands, number, unneeded) in enumerate(program.steps):
            if operation == "input":
                values[place] = inputs[int(number)]
                slopes[place] = library.array(1.0) if number == variable else None
                continue
            x = [values[i] for i in operands]
            values[place], carry = _OPERATIONS[operation](library, number, *x)
            varied = [(n, slopes[i]) for n, i in enumerate(operands) if slopes[i] is not None]
            if varied:
                slopes[place] = sum(carry(n, slope) for n, slope in varied)
            for i in unneeded:
                values[i] = slopes[i] = None
    return [values[i] for i in program.wanted], [slopes[i] for i in program.wanted]


def _checked(function, arguments, ranges):
    """The library, whether all arguments of a contact are in their ranges, and the arguments, with
    a number that is in every range in place of those that are not."""
    library, checked, known = _Library(function, arguments), {}, []
    for name, value in arguments.items():
        x = library.array(value if _is_foreign(value) else as_numbers(function, name, value))
        known.append(ranges[name].holds(x))
        checked[name] = library.where(known[-1], x, 0.25)
    try:
        numpy.broadcast_shapes(*(tuple(x.shape) for x in checked.values()))
    except ValueError:
        shapes = ", ".join(f"{n} {tuple(x.shape)}" for n, x in checked.items() if x.shape)
        raise InputError(function, "shapes", shapes, "shapes that broadcast to one") from None
    return library, functools.reduce(operator.and_, known), checked


def _are_normal(library, numbers):
    """Whether they are positive and have all their digits, with room for an area in mm²."""
    limits, normal = library.of.finfo(library.dtype), True
    for x in numbers:
        normal = (x >= float(limits.smallest_normal)) & (x <= 1e-6 * float(limits.max)) & normal
    return normal


class Contact(NamedTuple):
    """Contact ellipse, pressure and friction, as in `softfinger.Prediction` under Coulomb's law."""

    a_m: Any  #: semi-axis along the contact's long axis, a >= b
    b_m: Any  #: semi-axis along the short axis
    indentation_m: Any  #: approach d of the two bodies
    area_m2: Any  #: pi a b
    peak_pressure_Pa: Any
    torque_arm_exact_m: Any  #: (int p r dA)/P of frictionless pressing
    torque_arm_paper_m: Any  #: that of the circle of radius sqrt(ab) (Ciocarlie et al. 2007)
    max_force_N: Any  #: mu P
    max_torque_Nm: Any  #: mu P e_n
    eccentricity_m: Any  #: e_n of the friction ellipsoid: the exact arm
    pressure_arm_m: Any  #: (int p r dA)/P as pressed
    normal_stiffness_N_per_m: Any  #: dP/dd at the load; None unless asked for


#: Stands for all that sticks: the ratios no longer change.
_STICKS = 1e6


def _check_pressing(function, pressing):
    if pressing not in _PRESSINGS:
        raise InputError(function, "pressing", pressing, choices(pressing, _PRESSINGS))
    return pressing != "frictionless"


def _pressing_friction(library, pressing, friction):
    return library.array(_STICKS) if pressing == "stuck" else friction


def _contact(function, program, arguments, pressing, with_stiffness):
    library, known, x = _checked(function, arguments, _RANGES)
    with numpy.errstate(all="ignore"):
        ratio = x["radius_major_m"] / x["radius_minor_m"]
    known = known & (ratio >= 1) & (ratio <= _TABLES["largest_radii_ratio"])
    mu = x["friction_coefficient"]
    inputs = [x[name] for name in _INPUTS] + [_pressing_friction(library, pressing, mu)]
    numbers, slopes = _replay(library, program, inputs, 0 if with_stiffness else None)
    *numbers, pressure_arm = numbers if pressing != "frictionless" else [*numbers, numbers[4]]
    a, b, _, _, arm, paper_arm = numbers
    with numpy.errstate(all="ignore"):
        force = mu * x["normal_force_N"]
        torque, area = force * arm, math.pi * a * b
        stiffness = 1 / slopes[2] if with_stiffness else None
        with_friction = _are_normal(library, (force, torque, force * paper_arm))
        known = known & _are_normal(library, (*numbers, area)) & ((mu == 0) | with_friction)
    fields = [*numbers[:3], area, *numbers[3:], force, torque, arm, pressure_arm, stiffness]
    return Contact(*(None if n is None else library.where(known, n, math.nan) for n in fields))


@suggests_keywords
def fingertip_layer(
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    radius_major_m,
    radius_minor_m,
    friction_coefficient,
    finger_xx_per_m=0.0,
    finger_yy_per_m=0.0,
    finger_xy_per_m=0.0,
    is_object_spherical: bool = False,
    pressing: str = "coulomb",
    with_stiffness: bool = False,
) -> Contact:
    """Contact of a curved finger's layer at finite strain, the recommended model of one layer.

    Equations and their source are those of `softfinger.models()["fingertip_layer"]`, and of
    rubbed_prediction.h for friction while pressing; a rigid object.

    Args:
        normal_force_N: load P, positive and finite
        youngs_modulus_Pa: E of the layer, positive and finite
        poisson_ratio: nu, 0 to 0.5
        thickness_m: h, positive and finite
        radius_major_m, radius_minor_m: R' >= R'' of the gap, positive; R'/R'' to 22,026 (e^10)
        friction_coefficient: mu, finite and not negative
        finger_xx_per_m, finger_yy_per_m, finger_xy_per_m: the finger's own curvature, finite
        is_object_spherical: the object is an exact sphere, not its paraboloid
        pressing: friction while pressing: "coulomb", "stuck" or "frictionless"
        with_stiffness: whether dP/dd is wanted, which takes half as long again

    Returns:
        Contact of the shape to which the arguments broadcast; NaN where there is no answer

    Raises:
        InputError: an argument is no array of floating-point numbers, or shapes do not broadcast
    """
    arguments = {name: value for name, value in locals().items() if name in _RANGES}
    function = "arrays.fingertip_layer"
    is_rubbed = _check_pressing(function, pressing)
    program = _program("fingertip_layer", bool(is_object_spherical), is_rubbed)
    return _contact(function, program, arguments, pressing, with_stiffness)


@suggests_keywords
def bonded_layer(
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    radius_major_m,
    radius_minor_m,
    friction_coefficient,
    pressing: str = "coulomb",
    with_stiffness: bool = False,
) -> Contact:
    """Contact of a flat layer of any thickness in linear elasticity, bonded to a rigid base.

    Equations and their source are those of `softfinger.models()["bonded_layer"]`, and of
    rubbed_prediction.h for friction while pressing; a rigid object. Arguments, results and errors
    are those of `fingertip_layer`.
    """
    arguments = {name: value for name, value in locals().items() if name in _RANGES}
    arguments.update(finger_xx_per_m=0.0, finger_yy_per_m=0.0, finger_xy_per_m=0.0)
    function = "arrays.bonded_layer"
    program = _program("bonded_layer", _check_pressing(function, pressing))
    return _contact(function, program, arguments, pressing, with_stiffness)


class Bounds(NamedTuple):
    """Relative errors against finite elements of the whole finger that 95 % of all contacts keep;
    infinite where they are not known."""

    a: Any
    b: Any
    indentation: Any
    area: Any
    peak_pressure: Any
    max_torque: Any


_BOUNDED = tuple(
    Contact._fields.index(name)
    for name in ("a_m", "b_m", "indentation_m", "area_m2", "peak_pressure_Pa", "torque_arm_exact_m")
)


def error_bound(
    model: str = "fingertip_layer",
    is_object_spherical: bool = False,
    pressing: str = "coulomb",
    **contact,
) -> Bounds:
    """How far a model is from the whole finger, as `softfinger.error_bound` has it.

    The derivative of a bound is NaN where finger_xy_per_m is 0: a bound has a corner there.

    Args:
        model: "fingertip_layer" or "bonded_layer"
        pressing: as of `fingertip_layer`
        contact: the arguments of `fingertip_layer`, without `with_stiffness`

    Returns:
        Bounds of the shape to which the arguments broadcast

    Raises:
        InputError: the model is another one, or as of `fingertip_layer`
    """
    models = ("fingertip_layer", "bonded_layer")
    if model not in models:
        raise InputError("arrays.error_bound", "model", model, choices(model, models))
    is_rubbed = _check_pressing("arrays.error_bound", pressing)
    finger = fingertip_layer(
        **contact, is_object_spherical=is_object_spherical, pressing="frictionless"
    )
    answer = finger
    if model == "bonded_layer":
        flat = {n: x for n, x in contact.items() if not n.startswith("finger_")}
        answer = bonded_layer(**flat, pressing="frictionless")
    arguments = {**dict.fromkeys(_INPUTS[6:], 0.0), **contact}
    library, known, x = _checked("arrays.error_bound", arguments, _RANGES)
    program = _program("error_bands", bool(is_object_spherical))
    inputs = [x[name] for name in _INPUTS]
    numbers, _ = _replay(library, program, inputs)
    missed = [0.0] * len(_BOUNDED)
    if is_rubbed:
        program = _program("pressing_errors", bool(is_object_spherical), model == models[0])
        mu = _pressing_friction(library, pressing, x["friction_coefficient"])
        missed = _replay(library, program, [*inputs, mu])[0]
        missed = [*(library.where(mu > 0, one, 0.0) for one in missed), 0.0]
    widths, excesses = numbers[: len(_BOUNDED)], numbers[len(_BOUNDED) :]
    for excess in excesses:
        known = known & (excess <= 0)
    bounds = []
    for i, width, left_out in zip(_BOUNDED, widths, missed):
        ratio = answer[i] / finger[i]
        bound = library.of.abs(ratio - 1) + ratio * width + left_out
        bounds.append(library.where(known & (bound >= 0), bound, math.inf))
    return Bounds(*bounds)


class StuckStiffness(NamedTuple):
    """Stiffness of a contact of which no point slides."""

    torsional_Nm_per_rad: Any
    tangential_x_N_per_m: Any  #: along the semi-axis a
    tangential_y_N_per_m: Any  #: along the semi-axis b


@suggests_keywords
def stuck_stiffness(*, a_m, b_m, thickness_m, youngs_modulus_Pa, poisson_ratio) -> StuckStiffness:
    """Stiffness of a stuck ellipse on a layer that is bonded to a rigid base.

    A blend of the exact limits of thick and thin layers with a fitted correction
    (stuck_stiffness.h): within 0.1 % of spectral solutions for sqrt(ab)/h from 0.005 to 100 and a/b
    to 20.

    Args:
        a_m, b_m: semi-axes, positive and finite
        thickness_m: h, positive and finite
        youngs_modulus_Pa: E, positive and finite
        poisson_ratio: nu, 0 to 0.5

    Returns:
        StuckStiffness of the shape to which the arguments broadcast

    Raises:
        InputError: as of `fingertip_layer`
    """
    arguments = dict(locals())
    ranges = {**_RANGES, "a_m": POSITIVE, "b_m": POSITIVE}
    library, known, x = _checked("arrays.stuck_stiffness", arguments, ranges)
    numbers, _ = _replay(library, _program("stuck_stiffness"), list(x.values()))
    known = known & _are_normal(library, numbers)
    return StuckStiffness(*(library.where(known, n, math.nan) for n in numbers))


class Pad(NamedTuple):
    """What a flat pad holds, as in `softfinger.PadPrediction`."""

    indentation_m: Any  #: approach d of the two faces
    normal_stiffness_N_per_m: Any  #: P/d
    pressure_arm_m: Any  #: (int p r dA)/P as pressed
    max_force_N: Any  #: mu P
    max_torque_Nm: Any  #: mu P e_n
    eccentricity_m: Any  #: e_n: the arm of frictionless pressing
    torque_bound: Any  #: relative, against finite elements of the pad; infinite: not known


@suggests_keywords
def pad_layer(
    pad: FlatPad,
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    friction_coefficient,
    pressing: str = "stuck",
) -> Pad:
    """A flat pad on a flat face, loaded in its middle: the `pad_layer` of `FlatPad.predict`.

    Args:
        pad: one outline for all contacts of the call
        normal_force_N: load P, positive and finite
        youngs_modulus_Pa: E, positive and finite
        poisson_ratio: nu, 0 to 0.5
        thickness_m: h, positive; size over h from 0.001 to 10,000
        friction_coefficient: mu, finite and not negative
        pressing: "stuck", as rubber is, or "frictionless"

    Returns:
        Pad of the shape to which the arguments broadcast

    Raises:
        InputError: an unknown pressing, or as of `fingertip_layer`
    """
    function = "arrays.pad_layer"
    arguments = {name: value for name, value in locals().items() if name in _RANGES}
    if pressing not in PRESSINGS:
        raise InputError(function, "pressing", pressing, choices(pressing, PRESSINGS))
    if not isinstance(pad, FlatPad):
        raise InputError(function, "pad", pad, "a softfinger.FlatPad")
    library, known, x = _checked(function, arguments, _RANGES)
    layer = [x[name] for name in ("youngs_modulus_Pa", "poisson_ratio", "thickness_m")]
    program = _Program.of(_core.arrays.pad_layer(pad._shape, pressing == "stuck"))
    (stiffness, pressed, slipping), _ = _replay(library, program, layer)
    load, mu, h = x["normal_force_N"], x["friction_coefficient"], x["thickness_m"]
    with numpy.errstate(all="ignore"):
        indentation, force, width = load / stiffness, mu * load, pad._shape.size_m / h
        least, narrowest, widest, most = _TABLES["pad_widths"]
        known = known & (width > least) & (width < most)
        known = known & _are_normal(library, (indentation, stiffness, pressed, slipping))
        within = (width >= narrowest) & (width <= widest)
        within = within & (indentation <= _TABLES["pad_strain"] * h)
        uniform_bound, bound = pad._shape.torque_bounds
        bound = library.where(x["poisson_ratio"] == 0, uniform_bound, bound)
        torque = force * slipping
    numbers = (indentation, stiffness, pressed, force, torque, slipping)
    return Pad(
        *(library.where(known, number, math.nan) for number in numbers),
        library.where(known & within, bound, math.inf),
    )


def utilisation(max_force_N, eccentricity_m, force_x_N, force_y_N, torque_Nm):
    """How much of the friction ellipsoid a force and a torque use: below 1 the contact sticks.

    sqrt(f²/(mu P)² + tau²/(e_n mu P)²) (Ciocarlie et al. 2007, eq. 1 and 6), see
    `softfinger.FrictionEllipsoid`. Infinite for a load that a vanishing limit cannot carry, 0 for
    none. The derivative at no load is zero.

    Args:
        max_force_N, eccentricity_m: mu P and e_n of a Contact or a Pad, finite and not negative
        force_x_N, force_y_N, torque_Nm: what is to be carried, finite

    Returns:
        array of the shape to which the arguments broadcast

    Raises:
        InputError: as of `fingertip_layer`
    """
    arguments = dict(locals())
    limit, load = _RANGES["friction_coefficient"], _RANGES["finger_xy_per_m"]
    ranges = dict(zip(arguments, (limit, limit, load, load, load)))
    library, known, x = _checked("arrays.utilisation", arguments, ranges)

    def square(load, limit):
        share = load / library.where(limit == 0, 1.0, limit)
        return library.where((limit == 0) & (load != 0), math.inf, share * share)

    force = x["max_force_N"]
    squares = square(x["force_x_N"], force) + square(x["force_y_N"], force)
    squares = squares + square(x["torque_Nm"], force * x["eccentricity_m"])
    root = library.of.sqrt(library.where(squares == 0, 1.0, squares))
    return library.where(known, library.where(squares == 0, 0.0, root), math.nan)


class Sample(NamedTuple):
    """Fingers drawn by `sample`, and their contacts. The leading axis of every array counts the
    fingers."""

    youngs_modulus_Pa: Any
    poisson_ratio: Any
    thickness_m: Any
    friction_coefficient: Any
    contact: Contact  #: with the normal stiffness


@suggests_keywords
def sample(
    count: int,
    seed: int,
    *,
    normal_force_N,
    youngs_modulus_Pa: float,
    poisson_ratio: float,
    thickness_m: float,
    radius_major_m,
    radius_minor_m,
    friction_coefficient: float,
    finger_xx_per_m=0.0,
    finger_yy_per_m=0.0,
    finger_xy_per_m=0.0,
    youngs_modulus_factor: float = 1.0,
    thickness_factor: float = 1.0,
    friction_factor: float = 1.0,
    poisson_ratio_std: float = 0.0,
    model: str = "fingertip_layer",
) -> Sample:
    """Fingers whose material, thickness and friction are in doubt, for domain randomisation.

    Stiffness, mu and e_n of a finger belong together, because all follow from its one E, h, nu and
    mu. E, h and mu are log-normal about the given medians: 95 % lie between the median over the
    factor and the median times the factor, as a case file's `factor` means. nu is normal; what
    falls outside 0 to 1/2 is drawn again. The four are independent of each other. Draws are numpy's
    `default_rng(seed)`, in double precision, and the same for every array library.

    Args:
        count: of fingers, 1 or more
        seed: of the random numbers, a whole number from 0
        normal_force_N, radius_major_m, radius_minor_m, finger_xx_per_m, finger_yy_per_m,
            finger_xy_per_m: the contacts of each finger, arrays that broadcast to a shape S;
            ranges as of `fingertip_layer`
        youngs_modulus_Pa, poisson_ratio, thickness_m, friction_coefficient: one number each
        youngs_modulus_factor, thickness_factor, friction_factor: 1 (no doubt) or more
        poisson_ratio_std: 0 (no doubt) to 0.5
        model: "fingertip_layer" or "bonded_layer", which ignores the finger's curvature

    Returns:
        Sample. Its contact has arrays of the shape (count, *S), the drawn numbers (count, 1, .., 1)

    Raises:
        InputError: an argument is out of its range, or as of `fingertip_layer`
    """
    arguments, function = dict(locals()), "arrays.sample"

    def number(name, allowed):
        value = as_numbers(function, name, arguments[name])
        if value.shape:
            raise InputError(function, name, arguments[name], "one number")
        check_range(function, name, value, allowed)
        return float(value)

    for name, least in (("count", 1), ("seed", 0)):
        value = arguments[name]
        if isinstance(value, bool) or not isinstance(value, (int, numpy.integer)) or value < least:
            raise InputError(function, name, value, f"a whole number from {least}")
    models = {"fingertip_layer": fingertip_layer, "bonded_layer": bonded_layer}
    if model not in models:
        raise InputError(function, "model", model, choices(model, models))

    names = ("normal_force_N", "radius_major_m", "radius_minor_m", *_INPUTS[6:])
    contacts = {name: arguments[name] for name in names}
    library, _, arrays = _checked(function, contacts, _RANGES)
    shape = (count,) + (1,) * max(len(x.shape) for x in arrays.values())
    generator = numpy.random.default_rng(seed)
    drawn = {}
    for name, factor in (
        ("youngs_modulus_Pa", "youngs_modulus_factor"),
        ("thickness_m", "thickness_factor"),
        ("friction_coefficient", "friction_factor"),
    ):
        sigma = math.log(number(factor, AT_LEAST_ONE)) / 2
        drawn[name] = number(name, _RANGES[name]) * numpy.exp(
            sigma * generator.standard_normal(count)
        )
    middle, std = number("poisson_ratio", POISSON), number("poisson_ratio_std", POISSON)
    nu = middle + std * generator.standard_normal(count)
    while (outside := ~POISSON.holds(nu)).any():
        nu[outside] = middle + std * generator.standard_normal(outside.sum())
    drawn["poisson_ratio"] = nu
    drawn = {name: library.array(values.reshape(shape)) for name, values in drawn.items()}
    if model == "bonded_layer":
        contacts = {name: contacts[name] for name in names[:3]}
    contact = models[model](**contacts, **drawn, with_stiffness=True)
    return Sample(*(drawn[name] for name in Sample._fields[:4]), contact)
