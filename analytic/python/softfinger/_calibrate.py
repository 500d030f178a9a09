"""Material, thickness and friction of a fingertip from measurements of its contacts."""

from __future__ import annotations

import collections.abc
import dataclasses
from typing import Any, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import (
    ARRAYS,
    POSITIVE,
    PRESSINGS,
    SCALARS,
    SHEAR_LAWS,
    Contacts,
    Range,
    as_numbers,
    broadcast,
    check_range,
    check_pressing,
    check_shear_law,
    single_model,
)
from ._errors import InputError
from ._names import choices, suggests_keywords
from ._result import Result, masked_where_nan, result

#: Of what may be measured: the argument's name by the program's.
_QUANTITIES = {
    "a": "a_m",
    "b": "b_m",
    "area": "area_m2",
    "indentation": "indentation_m",
    "max_torque": "max_torque_Nm",
    "tangential_force": "tangential_force_N",
}
_FRICTIONAL = ("max_torque", "tangential_force")
#: Those that can be looked for, with the argument or key of `fixed` that each is.
_PARAMETERS = {
    "youngs_modulus": "youngs_modulus_Pa",
    "thickness": "thickness_m",
    "poisson_ratio": "poisson_ratio",
    "radius": "radius_m",
    "friction_coefficient": "friction_coefficient",
    "shear_strength": "shear_strength_Pa",
}
_RANGES = {name: (low, high) for name, _, low, high in _core.parameter_ranges()}
_MODELS = ("fingertip_layer", "bonded_layer", "winkler", "hertz")  # those with derivatives
# A search begins there where nothing was said.
_GUESS = {
    "friction_coefficient": 0.5,
    "shear_strength": 2e4,
    "radius_coefficient": 2e-3,
    "radius_exponent": 0.3,
    "zero": 0.0,
    "compliance": 0.0,
}

# The square of the least is still a number.
_MEASURED = Range(
    lambda x: numpy.isnan(x) | ((x >= 1e-100) & (x <= 1e100)),
    "positive and finite, or NaN where it was not measured",
)
_STD = Range(_MEASURED.holds, "positive and finite, or NaN where it is not known")


@result
class Estimate(Result):
    """One parameter that was looked for, in SI units."""

    name: str
    unit: str  #: "Pa", "m" or ""
    value: float
    std: float  #: infinite where the data do not tell the parameter at all
    interval95: tuple[float, float]  #: by profile likelihood: holds the truth in 95 % of all cases
    interval_open: tuple[bool, bool]  #: ends at the border of what was searched
    determined: bool  #: the interval spans less than a factor of two


@result
class Outlier(Result):
    """A measurement that was left out: a fit to the others predicts it too badly to be chance."""

    quantity: str  #: name of the argument, "a_m"
    index: tuple[int, ...]  #: of its element
    load_N: float
    measured: float
    predicted: float  #: by the fit to the others
    deviation: float  #: (measured - predicted)/std


@result
class ModelFit(Result):
    """A model or a shear law, fitted to the same data for comparison."""

    name: str
    aic: float  #: Akaike's criterion; above the least by 2 is little, by 10 much
    scatter: float  #: root mean square of (measured - predicted)/predicted
    #: on the upper third of the loads, by a fit to the others; None: too few of them
    held_out_error: Optional[float]
    parameters: dict[str, float]  #: by name, SI units


@result
class NextMeasurement(Result):
    """The one further measurement that would help most with the parameter that is known worst."""

    quantity: str  #: name of an argument, or "thickness_m", with a caliper
    load_N: Optional[float]  #: None for the thickness
    relative_std: float  #: that it is supposed to have
    parameter: str
    std_now: float  #: of the parameter, relative (of nu, absolute); infinite: not known at all
    std_then: float


@result
class Goodness(Result):
    """How well the model fits."""

    probability: Optional[float]  #: of a worse fit by chance alone; None without stated errors
    error_factor: float  #: by which stated errors were multiplied, being too small for the fit
    sum_of_squares: float  #: in standard deviations
    degrees_of_freedom: int
    scatter: dict[str, float]  #: relative, of values without a stated error, by argument


@result
class Curve(Result):
    """A quantity over the load, and where chance leaves the fit itself in 95 % of all cases."""

    load_N: numpy.ndarray  #: (41,)
    value: numpy.ndarray  #: (41,)
    low: numpy.ndarray  #: (41,); masked where the covariance is not known
    high: numpy.ndarray  #: (41,)


@result
class Calibration(Result):
    """What measurements say of a fingertip. Measured quantities are named by their arguments."""

    model: str
    shear_law: str
    parameters: dict[str, Estimate]  #: those looked for, by name
    fixed: dict[str, float]  #: those taken as known, by name, SI units
    covariance: Optional[numpy.ndarray]  #: (n, n) of `parameters`, SI; None: some combination open
    cannot_tell: tuple[str, ...]  #: what the data leave open, in words
    next_measurement: Optional[NextMeasurement]  #: None where no single one would help much
    models: tuple[ModelFit, ...]  #: the best first
    shear_laws: tuple[ModelFit, ...]  #: the best first; empty where no friction was measured
    outliers: tuple[Outlier, ...]
    goodness: Goodness
    growth_exponent: Optional[tuple[float, float]]  #: d ln a/d ln P and its standard deviation
    contact: dict[str, Any]  #: the fitted contact, for predict(**found.contact, normal_force_N=..)
    #: (...,), as given; so are the shapes of the next four, whose arrays go by argument
    load_N: numpy.ndarray = dataclasses.field(repr=False)
    measured: dict[str, numpy.ndarray] = dataclasses.field(repr=False)  #: masked: not measured
    std: dict[str, numpy.ndarray] = dataclasses.field(repr=False)  #: stated, or from the scatter
    predicted: dict[str, numpy.ndarray] = dataclasses.field(repr=False)  #: where measured
    deviation: dict[str, numpy.ndarray] = dataclasses.field(repr=False)  #: (measured-predicted)/std
    #: from somewhat below the least load to somewhat above the largest
    curves: dict[str, Curve] = dataclasses.field(repr=False)


@suggests_keywords
def calibrate(
    *,
    load_N: ArrayLike,
    radius_major_m: float,
    radius_minor_m: float,
    youngs_modulus_Pa: float,
    thickness_m: float,
    poisson_ratio: float,
    a_m: Optional[ArrayLike] = None,
    a_m_std: Optional[ArrayLike] = None,
    b_m: Optional[ArrayLike] = None,
    b_m_std: Optional[ArrayLike] = None,
    area_m2: Optional[ArrayLike] = None,
    area_m2_std: Optional[ArrayLike] = None,
    indentation_m: Optional[ArrayLike] = None,
    indentation_m_std: Optional[ArrayLike] = None,
    max_torque_Nm: Optional[ArrayLike] = None,
    max_torque_Nm_std: Optional[ArrayLike] = None,
    tangential_force_N: Optional[ArrayLike] = None,
    tangential_force_N_std: Optional[ArrayLike] = None,
    friction_coefficient: Optional[float] = None,
    shear_strength_Pa: Optional[float] = None,
    shear_law: str = "coulomb",
    pressing: Optional[str] = None,
    finger_xx_per_m: float = 0.0,
    finger_yy_per_m: float = 0.0,
    finger_xy_per_m: float = 0.0,
    winkler_modulus: str = "oedometric",
    fit: Union[None, str, Sequence[str]] = None,
    fixed: Optional[Mapping[str, float]] = None,
    model: Optional[str] = None,
) -> Calibration:
    """Modulus, thickness and friction of a fingertip from measured contacts, with intervals: the
    numbers of `softfinger calibrate`.

    Weighted least squares of the logarithms from several starting points, outliers taken out;
    intervals by profile likelihood (softfinger/calibration/calibrate.h). Some 50 ms for 20 loads
    and four parameters. Other threads run meanwhile.

    Args:
        load_N: (...,) loads, positive; one may occur several times
        a_m, b_m: (...,) semi-axes, broadcasting with the loads, as do all that follow
        area_m2: of the contact
        indentation_m: approach of the bodies
        max_torque_Nm: about the normal, at slip
        tangential_force_N: at slip
        a_m_std, ..: standard deviations; NaN or absent: from the scatter about the fit. (What was
            not measured may be NaN or masked in all of these; in the results it is masked.)
        radius_major_m, radius_minor_m: relative radii R' >= R''; see `gap_between`
        finger_xx_per_m, finger_yy_per_m, finger_xy_per_m: the finger's own curvature; see `predict`
        youngs_modulus_Pa, thickness_m, poisson_ratio: of the layer, to start from, or as known
        friction_coefficient, shear_strength_Pa: the same; as the shear law has them
        shear_law: as `predict` has it
        pressing: as `predict` has it; default: by Coulomb's law where that is the shear law and its
            coefficient is given or to be found
        fit: what to find, out of "youngs_modulus", "thickness", "poisson_ratio", "radius",
            "friction_coefficient", "shear_strength"; default: the first two, and where friction was
            measured what the shear law has. Not the thickness for hertz and winkler, which cannot
            tell it.
        fixed: values in place of those to start from, not fitted; keys "youngs_modulus_Pa",
            "thickness_m", "poisson_ratio", "radius_m" (sqrt(R' R'')), "friction_coefficient",
            "shear_strength_Pa"
        model: "fingertip_layer", "bonded_layer", "winkler" or "hertz"; default: the recommended one
        winkler_modulus: as `predict` has it

    Returns:
        Calibration

    Raises:
        InputError: an argument is out of its range; there are not more values than parameters; the
            model has no answer; or no model explains the data: it tells which values are off, and
            by how much
    """
    given = dict(locals())
    if model is not None and model not in _MODELS:
        raise InputError("calibrate", "model", model, choices(model, _MODELS))
    check_shear_law("calibrate", shear_law)
    fixed = _fixed_values(fixed)
    loads, measured, stds = _measurements(given)
    names = _parameters_to_find(fit, fixed, model, shear_law, measured)
    start = _start(given, fixed, names, shear_law)

    unique_N, contact_of_row = numpy.unique(loads.reshape(-1), return_inverse=True)
    contacts = _contacts(given, start, unique_N)
    if pressing is None and not _takes_part("friction_coefficient", names, given, fixed, shear_law):
        pressing = "frictionless"
    given["pressing"] = pressing = check_pressing("calibrate", shear_law, pressing)
    model = single_model("calibrate", contacts, model)  # the loads are those of one finger
    rows = list(_rows(measured))
    quantity, index = numpy.array(rows).T
    every = list(_QUANTITIES)
    value, std = (
        numpy.array([arrays[every[q]].reshape(-1)[i] for q, i in rows])
        for arrays in (measured, stds)
    )
    if len(rows) <= len(names):
        raise InputError(
            "calibrate",
            "number of measured values",
            len(rows),
            f"more than the {len(names)} parameters to find ({', '.join(names)}); fit chooses fewer",
        )
    margin = 1.3  # beyond the loads, as the program draws it
    curve_loads_N = numpy.geomspace(unique_N[0] / margin, unique_N[-1] * margin, 41)
    found = _core.calibrate(
        model,
        contacts.numbers,
        quantity,
        contact_of_row.reshape(-1)[index],
        value,
        numpy.nan_to_num(std),
        SHEAR_LAWS.index(shear_law),
        PRESSINGS.index(pressing),
        [list(_RANGES).index(name) for name in names],
        numpy.array([start[name] for name in _RANGES]),
        curve_loads_N,
    )

    def in_shape(name):
        arrays = {q: numpy.full(loads.shape, numpy.nan) for q in every if q in measured}
        for (q, i), number in zip(rows, found[name]):
            arrays[every[q]].reshape(-1)[i] = number
        return {_QUANTITIES[q]: masked_where_nan(array) for q, array in arrays.items()}

    predicted, deviation = in_shape("predicted"), in_shape("deviation")
    outliers = []
    for q, i in (rows[k] for k in found["outliers"]):
        name, at = _QUANTITIES[every[q]], numpy.unravel_index(i, loads.shape)
        numbers = (x[at] for x in (measured[every[q]], predicted[name], deviation[name]))
        place = tuple(int(n) for n in at)
        outliers.append(Outlier(name, place, float(loads[at]), *map(float, numbers)))
    probability, error_factor, sum_of_squares = found["goodness"]
    values = found["values"]
    return Calibration(
        model=model,
        shear_law=shear_law,
        parameters={one[0]: Estimate(*one) for one in found["parameters"]},
        fixed=_known(values, names, given, fixed, shear_law),
        covariance=found["covariance"],
        cannot_tell=tuple(found["cannot_tell"]),
        next_measurement=_next(found["next_measurement"]),
        models=tuple(map(_model_fit, found["models"])),
        shear_laws=tuple(map(_model_fit, found["shear_laws"])),
        outliers=tuple(outliers),
        goodness=Goodness(
            probability if (std > 0).any() else None,
            error_factor,
            sum_of_squares,
            len(rows) - len(outliers) - len(names),
            {_QUANTITIES[q]: scatter for q, scatter in found["scatter"].items()},
        ),
        growth_exponent=found["growth_exponent"],
        load_N=loads,
        measured={_QUANTITIES[q]: masked_where_nan(array) for q, array in measured.items()},
        std=in_shape("std"),
        predicted=predicted,
        deviation=deviation,
        curves={
            _QUANTITIES[q]: Curve(curve_loads_N, *map(masked_where_nan, curve))
            for q, curve in found["curves"].items()
        },
        contact=_contact(values, names, given, fixed, shear_law),
    )


def _model_fit(found):
    name, aic, scatter, held_out_error, parameters = found
    return ModelFit(
        name, aic, scatter, None if numpy.isnan(held_out_error) else held_out_error, parameters
    )


def _fixed_values(fixed):
    """By the parameter's name."""
    keys = {key: name for name, key in _PARAMETERS.items()}
    values = {}
    if fixed is not None and not isinstance(fixed, collections.abc.Mapping):
        raise InputError("calibrate", "fixed", fixed, "a dict of numbers by " + ", ".join(keys))
    for key, value in (fixed or {}).items():
        if key not in keys:
            raise InputError("calibrate", "fixed", key, choices(key, keys))
        values[keys[key]] = _in_range(f"fixed[{key!r}]", keys[key], value)
    return values


def _in_range(argument, parameter, value):
    low, high = _RANGES[parameter]
    return _single(
        argument, value, Range(lambda x: (x >= low) & (x <= high), f"{low:g} to {high:g}")
    )


def _single(argument, value, allowed):
    number = as_numbers("calibrate", argument, value)
    if number.shape:
        raise InputError("calibrate", argument, f"array of shape {number.shape}", "one number")
    check_range("calibrate", argument, number, allowed)
    return float(number)


def _measurements(given):
    """Loads, and by quantity its values and their standard deviations, all of one shape."""
    function = "calibrate"
    arrays = {"load_N": as_numbers(function, "load_N", given["load_N"])}
    check_range(function, "load_N", arrays["load_N"], POSITIVE)
    for name in _QUANTITIES.values():
        for argument, allowed in ((name, _MEASURED), (name + "_std", _STD)):
            if given[argument] is None:
                continue
            if given[name] is None:
                raise InputError(function, argument, None, f"nothing: there is no {name}")
            arrays[argument] = as_numbers(function, argument, given[argument])
            check_range(function, argument, arrays[argument], allowed)
    shape, flat = broadcast(function, arrays)
    shape = shape or (1,)
    flat = {name: array.reshape(shape).copy() for name, array in flat.items()}
    nothing = numpy.full(shape, numpy.nan)
    measured = {q: flat[name] for q, name in _QUANTITIES.items() if name in flat}
    measured = {q: x for q, x in measured.items() if not numpy.isnan(x).all()}
    if not measured:
        names = ", ".join(_QUANTITIES.values())
        raise InputError(function, "measurements", "none", f"at least one value of {names}")
    return (
        flat["load_N"],
        measured,
        {q: flat.get(_QUANTITIES[q] + "_std", nothing) for q in measured},
    )


def _rows(measured):
    """(quantity, element) of each value: element by element, as the lines of a table."""
    size = next(iter(measured.values())).size
    every = list(_QUANTITIES)
    for i in range(size):
        for quantity, array in measured.items():
            if not numpy.isnan(array.reshape(-1)[i]):
                yield every.index(quantity), i


def _law_has(law, parameter):
    return not (parameter == "friction_coefficient" and law == "shear_strength") and not (
        parameter == "shear_strength" and law == "coulomb"
    )


def _parameters_to_find(fit, fixed, model, law, measured):
    function = "calibrate"
    frictional = ("friction_coefficient", "shear_strength")
    has_friction = any(quantity in measured for quantity in _FRICTIONAL)
    for name in fixed:
        if not _law_has(law, name):
            raise InputError(function, "fixed", _PARAMETERS[name], f"what {law!r} has")
    if fit is None:
        # Hertz knows no layer, and Winkler E and h only as E/h.
        names = ["youngs_modulus"] + (["thickness"] if model not in ("hertz", "winkler") else [])
        names += [name for name in frictional if has_friction and _law_has(law, name)]
        names = [name for name in names if name not in fixed]
    elif isinstance(fit, collections.abc.Iterable):
        names = [fit] if isinstance(fit, str) else list(fit)
    else:
        raise InputError(function, "fit", fit, "names out of " + ", ".join(_PARAMETERS))
    for name in names:
        if not isinstance(name, str) or name not in _PARAMETERS:
            raise InputError(function, "fit", name, choices(name, _PARAMETERS))
        if names.count(name) > 1:
            raise InputError(function, "fit", name, "each parameter once")
        if name in fixed:
            raise InputError(function, "fit", name, "either fit or fixed for a parameter")
        if not _law_has(law, name):
            raise InputError(function, "fit", name, f"what shear_law = {law!r} has")
        if name in frictional and not has_friction:
            raise InputError(
                function, "fit", name, "max_torque_Nm or tangential_force_N among the measurements"
            )
    if not names:
        raise InputError(function, "fit", fit, "at least one parameter to find")
    return names


def _start(given, fixed, names, law):
    """Every parameter's value to start from. Those to find are in the range that is searched."""
    start = dict(_GUESS)
    for name, argument in _PARAMETERS.items():
        if name == "radius":
            # Here and not with the contacts, as the roots need it.
            radii = [_single(n, given[n], POSITIVE) for n in ("radius_major_m", "radius_minor_m")]
            start[name] = float(numpy.sqrt(radii[0]) * numpy.sqrt(radii[1]))
        elif given[argument] is not None:
            if not _law_has(law, name):
                raise InputError(
                    "calibrate", argument, given[argument], f"nothing: {law!r} has none"
                )
            allowed = (
                next(n.range for n in ARRAYS if n.name == argument)
                if (argument != "shear_strength_Pa")
                else POSITIVE
            )
            start[name] = _single(argument, given[argument], allowed)
        if name in ("friction_coefficient", "shear_strength"):
            start[name] = max(_RANGES[name][0], start[name])
        if name in names:
            _in_range("radius" if name == "radius" else argument, name, start[name])
    return {**start, **fixed}


def _contacts(given, start, loads_N):
    """One for each load."""
    arguments = {number.name: number.default for number in ARRAYS + SCALARS}
    arguments.update({name: given[name] for name in arguments if given.get(name) is not None})
    arguments["pressing"] = None
    for name in ("youngs_modulus", "thickness", "poisson_ratio", "friction_coefficient"):
        arguments[_PARAMETERS[name]] = start[name]
    for name in ("finger_xx_per_m", "finger_yy_per_m", "finger_xy_per_m"):
        _single(name, given[name], next(n.range for n in ARRAYS if n.name == name))
    arguments["normal_force_N"] = loads_N
    return Contacts.of("calibrate", arguments)


def _takes_part(name, names, given, fixed, law):
    """Whether a parameter is known or was found: friction may have been left open."""
    if not _law_has(law, name):
        return False
    if name in ("friction_coefficient", "shear_strength"):
        return name in names or name in fixed or given[_PARAMETERS[name]] is not None
    return True


def _known(values, names, given, fixed, law):
    return {
        name: values[name]
        for name in _PARAMETERS
        if name not in names and _takes_part(name, names, given, fixed, law)
    }


def _contact(values, names, given, fixed, law):
    """Arguments of `predict`. The bodies keep their proportions when their radius changes."""
    factor = (
        values["radius"] / numpy.sqrt(given["radius_major_m"]) / numpy.sqrt(given["radius_minor_m"])
    )
    if abs(factor - 1) < 1e-12:  # rounding alone
        factor = 1.0
    contact = {name: float(given[name] * factor) for name in ("radius_major_m", "radius_minor_m")}
    for name in ("finger_xx_per_m", "finger_yy_per_m", "finger_xy_per_m"):
        contact[name] = float(given[name] / factor)
    for name, argument in _PARAMETERS.items():
        if name != "radius" and _takes_part(name, names, given, fixed, law):
            contact[argument] = values[name]
    if law != "coulomb":
        contact["shear_law"] = law
    if law == "coulomb" and given["pressing"] != "coulomb" and "friction_coefficient" in contact:
        contact["pressing"] = given["pressing"]  # not the default of `predict`
    contact["winkler_modulus"] = given["winkler_modulus"]
    return contact


def _next(found):
    if found is None:
        return None
    quantity, *others = found
    return NextMeasurement({"thickness": "thickness_m", **_QUANTITIES}[quantity], *others)
