"""The numbers of a contact: names, ranges and defaults, for all functions that take a contact."""

import dataclasses
import functools
import inspect
import math
import warnings
from typing import Any, Optional

import numpy

from . import _core
from ._errors import InputError
from ._names import choices, unexpected

REQUIRED = inspect.Parameter.empty


@dataclasses.dataclass(frozen=True)
class Range:
    holds: object  # of an array, elementwise
    allowed: str


POSITIVE = Range(lambda x: (x > 0) & (x < numpy.inf), "positive and finite")
NOT_NEGATIVE = Range(lambda x: (x >= 0) & (x < numpy.inf), "finite and not negative")
FINITE = Range(lambda x: (x > -numpy.inf) & (x < numpy.inf), "finite")
POISSON = Range(lambda x: (x >= 0) & (x <= 0.5), "0 to 0.5")
EXPONENT = Range(lambda x: (x > 0) & (x < 1), "between 0 and 1, both excluded")
AT_LEAST_ONE = Range(lambda x: (x >= 1) & (x < numpy.inf), "1 or more, finite")


@dataclasses.dataclass(frozen=True)
class Usual:
    """What fingertips and other soft contacts have, in SI units. A number outside of it is answered
    with a warning: most often it is in another unit than its name says."""

    low: float
    high: float
    words: str

    def holds(self, values):
        return (values >= self.low) & (values <= self.high)


_FORCE = Usual(1e-4, 1e4, "0.1 mN to 10 kN")
_MODULUS = Usual(1e3, 1e9, "1 kPa to 1 GPa")
_LAYER = Usual(1e-5, 0.1, "10 um to 100 mm")
_RADIUS = Usual(5e-5, 10.0, "0.05 mm to 10 m")
_CURVATURE = Usual(-2e4, 2e4, "that of radii above 0.05 mm")
_POISSON = Usual(0.0, 0.5, "0 to 0.5")
_FRICTION = Usual(0.01, 10.0, "0.01 to 10")


@dataclasses.dataclass(frozen=True)
class Number:
    name: str
    range: Range
    default: object
    meaning: str
    usual: Optional[Usual] = None  # a default is usual, too


# Broadcast against each other.
ARRAYS = (
    Number("normal_force_N", POSITIVE, REQUIRED, "load P", _FORCE),
    Number("youngs_modulus_Pa", POSITIVE, REQUIRED, "E of the layer", _MODULUS),
    Number("poisson_ratio", POISSON, REQUIRED, "nu of the layer", _POISSON),
    Number("thickness_m", POSITIVE, REQUIRED, "h of the layer", _LAYER),
    Number(
        "radius_major_m", POSITIVE, REQUIRED, "R', the longer relative radius of curvature", _RADIUS
    ),
    Number("radius_minor_m", POSITIVE, REQUIRED, "R'', at most R'", _RADIUS),
    Number("friction_coefficient", NOT_NEGATIVE, REQUIRED, "mu", _FRICTION),
    Number(
        "finger_xx_per_m",
        FINITE,
        0.0,
        "the finger's own curvature along the contact's long axis; 0: a flat layer",
        _CURVATURE,
    ),
    Number("finger_yy_per_m", FINITE, 0.0, "the same along its short axis", _CURVATURE),
    Number("finger_xy_per_m", FINITE, 0.0, "its twist", _CURVATURE),
    Number(
        "object_thickness_m",
        NOT_NEGATIVE,
        0.0,
        "of a layer on the object; 0: a rigid object",
        _LAYER,
    ),
    Number("object_youngs_modulus_Pa", NOT_NEGATIVE, 0.0, "of that layer", _MODULUS),
    Number("object_poisson_ratio", POISSON, 0.0, "of that layer", _POISSON),
)
# Friction while pressing, in the order of the C++ library's PressingFriction.
PRESSINGS = ("frictionless", "coulomb", "stuck")
# For all contacts of a call. The last four are for single models.
SCALARS = (
    Number(
        "pressing",
        None,
        None,
        "friction while pressing: 'coulomb', 'stuck' or 'frictionless'; None: by Coulomb's law where "
        "that is the shear law, and without friction on an object with a layer",
    ),
    Number(
        "is_object_spherical",
        None,
        False,
        "an exact sphere, not its paraboloid: for finite_strain_layer",
    ),
    Number("winkler_modulus", None, "oedometric", "'oedometric' or 'youngs': for winkler"),
    Number(
        "power_law_coefficient",
        NOT_NEGATIVE,
        0.0,
        "c of a_m = c (P_N)^gamma: for power_law; 0: no such law",
    ),
    Number("power_law_exponent", EXPONENT, 1 / 3, "gamma"),
    Number("power_law_pressure_exponent", AT_LEAST_ONE, 2.0, "k of p ~ (1 - (r/a)^k)^(1/k)"),
)

NUMBERS = ARRAYS + SCALARS

# What friction carries at a point, for functions that ask for the largest force and torque. A
# coefficient is required by the laws that have one.
SHEAR_LAWS = ("coulomb", "shear_strength", "limited", "adhesive_shear")
FRICTION_COEFFICIENT = Number(
    "friction_coefficient",
    NOT_NEGATIVE,
    None,
    "mu; needed by all laws but 'shear_strength', refused by that",
    _FRICTION,
)
SHEAR_STRENGTH = Number(
    "shear_strength_Pa",
    NOT_NEGATIVE,
    None,
    "tau_0, a shear stress; needed by all laws but 'coulomb', refused by that",
)
SHEAR_LAW = Number(
    "shear_law",
    None,
    "coulomb",
    "the shear stress at slip under a pressure p: 'coulomb' mu p, 'shear_strength' tau_0, "
    "'limited' min(mu p, tau_0), 'adhesive_shear' tau_0 + mu p",
)


#: In the order of `_core.models()`.
MODELS = tuple(card["name"] for card in _core.models())


def check_model(function, name):
    """Of a model's name, or None for the recommended model of each contact."""
    if name is not None and name not in MODELS:
        raise InputError(function, "model", name, choices(name, MODELS))
    return name


def models_of(contacts, name):
    """The model that answers all contacts, None where they have several; and its name for the result,
    or an array of names for arrays of contacts of which each gets the recommended one."""
    if name is not None:
        return name, name
    places = _core.default_models(contacts.numbers)
    if not contacts.shape:
        return (MODELS[places[0]],) * 2
    if places.size == 0 or (places == places[0]).all():
        common = MODELS[places[0]] if places.size else MODELS[0]
        return common, numpy.full(contacts.shape, common, dtype=object)
    return None, numpy.array(MODELS, dtype=object)[places].reshape(contacts.shape)


def single_model(function, contacts, name):
    """The checked model of what takes one contact only, or contacts of one finger."""
    model, names = models_of(contacts, check_model(function, name))
    return model or names.flat[0]


def as_numbers(function, name, value):
    """An array of doubles. What is masked is missing, and NaN."""
    if isinstance(value, numpy.ma.MaskedArray):
        value = numpy.ma.filled(value.astype(numpy.float64), numpy.nan)
    try:
        numbers = numpy.asarray(value)
        if numbers.dtype.kind not in "uif":  # no truth values, texts or complex numbers
            raise TypeError
        return numbers.astype(numpy.float64, copy=False)
    except (TypeError, ValueError):
        raise InputError(function, name, value, "a number or an array of numbers") from None


def check_range(function, name, values, allowed):
    """Refuses the first value outside of the range."""
    inside = allowed.holds(values)
    if inside.all():
        return
    refuse_first(function, name, values, inside, allowed.allowed)


def check_shear_law(function, law):
    if law not in SHEAR_LAWS:
        raise InputError(function, "shear_law", law, choices(law, SHEAR_LAWS))
    return law


def friction_of(function, law, friction_coefficient, shear_strength_Pa):
    """Coefficient and strength, 0 in place of what the law does not use.

    As in case files, what a law needs has to be there, and what it does not use is refused.
    """
    check_shear_law(function, law)
    given = {"friction_coefficient": friction_coefficient, "shear_strength_Pa": shear_strength_Pa}
    for name, other in (
        ("friction_coefficient", "shear_strength"),
        ("shear_strength_Pa", "coulomb"),
    ):
        if given[name] is None and law != other:
            raise InputError(function, name, None, f"a number: shear_law = {law!r} needs it")
        if given[name] is not None and law == other:
            raise InputError(function, name, given[name], f"nothing: shear_law = {law!r} has none")
    return tuple(0.0 if value is None else value for value in given.values())


def check_pressing(function, law, pressing):
    """The friction while pressing that is meant, by its name."""
    if pressing is None:
        return "coulomb" if law == "coulomb" else "frictionless"
    if not isinstance(pressing, str) or pressing not in PRESSINGS:
        raise InputError(function, "pressing", pressing, choices(pressing, PRESSINGS))
    if pressing != "frictionless" and law != "coulomb":
        allowed = "'frictionless' with another shear law than 'coulomb'"
        raise InputError(function, "pressing", pressing, allowed)
    return pressing


def _pressing_friction(flat):
    """The coefficient that acts while each contact is pressed. How two layers rub is not known."""
    friction = flat["friction_coefficient"]
    if flat["pressing"] == "frictionless":
        return numpy.zeros_like(friction)
    if flat["pressing"] == "stuck":
        friction = numpy.full_like(friction, numpy.inf)
    return numpy.where(flat["object_thickness_m"] > 0, 0.0, friction)


def refuse_first(function, name, values, inside, allowed):
    index = numpy.unravel_index(numpy.argmin(inside), numpy.shape(inside))
    place = "[" + ", ".join(str(int(i)) for i in index) + "]" if index else ""
    raise InputError(function, name + place, float(values[index]), allowed)


def warn_of_the_unusual(function, arrays, numbers):
    """One warning of a call, which names the first unusual value of each number."""
    found = []
    for number in numbers:
        values = arrays[number.name]
        if number.usual is None or number.usual.holds(values).all():
            continue
        odd = ~number.usual.holds(values) & (values != number.default)
        if odd.any():
            found.append(
                f"{number.name} = {float(values[odd].flat[0]):g} (usual: {number.usual.words})"
            )
    if found:
        warnings.warn(
            f"{function}: {', '.join(found)}: are units mixed up, millimetres for metres, kPa for "
            "Pa? All numbers are in SI units, and the answer is for them as they are",
            UserWarning,
            stacklevel=_levels_to_the_caller(),
        )


def _levels_to_the_caller():
    """To the line outside of this package that called it: what the warning is about."""
    frame, level = inspect.currentframe().f_back, 1
    while frame.f_back and frame.f_globals.get("__package__") == __package__:
        frame, level = frame.f_back, level + 1
    return level


def broadcast(function, arrays):
    """Named arrays in their common shape.

    Returns:
        (shape, the arrays by name: one-dimensional and contiguous)
    """
    try:
        shape = numpy.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.shape)
        raise InputError(function, "shapes", shapes, "shapes that broadcast to one") from None
    return shape, {name: _flat(array, shape) for name, array in arrays.items()}


def _flat(array, shape):
    if not array.shape:  # most arguments: broadcast_to takes ten times as long
        return numpy.full(math.prod(shape), array)
    return numpy.ascontiguousarray(numpy.broadcast_to(array, shape)).reshape(-1)


@dataclasses.dataclass(frozen=True)
class Contacts:
    """Checked contacts, as the compiled part takes them."""

    shape: tuple
    numbers: dict  # flat arrays and scalars by name

    @classmethod
    def of(cls, function, arguments):
        """Of the arguments by name; `shear_law` with its numbers may be among them."""
        numbers = ARRAYS
        law = arguments.get("shear_law", "coulomb")
        if "shear_law" in arguments:
            numbers = ARRAYS + (SHEAR_STRENGTH,)
            friction = friction_of(
                function,
                law,
                arguments["friction_coefficient"],
                arguments["shear_strength_Pa"],
            )
            names = ("friction_coefficient", "shear_strength_Pa")
            arguments = {**arguments, **dict(zip(names, friction))}
        shape, flat = (), ONE_CONTACT.numbers(arguments) if law == "coulomb" else None
        if flat is None:
            shape, flat = cls._checked(function, arguments, numbers)
        for number in SCALARS:
            value = arguments[number.name]
            if number.range is not None and value is not number.default:
                array = as_numbers(function, number.name, value)
                if array.shape:
                    raise InputError(function, number.name, value, "one number for all contacts")
                check_range(function, number.name, array, number.range)
                value = float(array)
            flat[number.name] = value
        flat["shear_law"] = law
        flat["pressing"] = check_pressing(function, law, flat["pressing"])
        flat["pressing_friction_coefficient"] = _pressing_friction(flat)
        if flat["winkler_modulus"] not in ("oedometric", "youngs"):
            raise InputError(
                function, "winkler_modulus", flat["winkler_modulus"], "'oedometric' or 'youngs'"
            )
        if not isinstance(flat["is_object_spherical"], (bool, numpy.bool_)):
            raise InputError(
                function, "is_object_spherical", flat["is_object_spherical"], "True or False"
            )
        return cls(shape, flat)

    @staticmethod
    def _checked(function, arguments, numbers):
        """The common shape, and the flat arrays by name."""
        arrays = {}
        for number in numbers:
            arrays[number.name] = as_numbers(function, number.name, arguments[number.name])
            check_range(function, number.name, arrays[number.name], number.range)
        warn_of_the_unusual(function, arrays, numbers)
        major, minor = arrays["radius_major_m"], arrays["radius_minor_m"]
        shape, flat = broadcast(function, arrays)
        if not (major >= minor).all():
            ordered = (flat["radius_minor_m"] <= flat["radius_major_m"]).reshape(shape)
            refuse_first(
                function,
                "radius_minor_m",
                flat["radius_minor_m"].reshape(shape),
                ordered,
                "at most radius_major_m",
            )
        has_layer = flat["object_thickness_m"] > 0
        if has_layer.any():
            stiff = (~has_layer | (flat["object_youngs_modulus_Pa"] > 0)).reshape(shape)
            if not stiff.all():
                refuse_first(
                    function,
                    "object_youngs_modulus_Pa",
                    flat["object_youngs_modulus_Pa"].reshape(shape),
                    stiff,
                    "positive where object_thickness_m is",
                )
        return shape, flat

    def require_single(self, function, instead):
        if self.shape:
            raise InputError(function, "shape", self.shape, f"one contact: {instead}")


def _documented(arrays, scalars):
    return "\n".join(
        [
            "",
            "Arguments of the contact, in SI units. Each is a number or an array; arrays broadcast:",
            "",
        ]
        + [
            f"    {number.name}: {number.meaning}; {number.range.allowed}"
            + (f"; default {number.default:g}" if isinstance(number.default, float) else "")
            for number in arrays
        ]
        + ["", "For all contacts of the call:", ""]
        + [
            f"    {number.name}: {number.meaning}"
            + (f"; {number.range.allowed}" if number.range else "")
            + f"; default {number.default!r}"
            for number in scalars
        ]
        + [
            "",
            "Raises:",
            "    InputError: an argument is out of its range; it names argument, value and range",
            "",
        ]
    )


#: One contact of plain and usual numbers, which the compiled part checks at once. For all else it gives
#: None: the words of refusals and warnings are here.
ONE_CONTACT = _core.OneContact(
    {n.name: (n.usual.low, n.usual.high, n.default is REQUIRED) for n in ARRAYS}
)


def takes_contacts(function, at_once=None):
    """Makes a function of checked contacts one of the numbers of contacts, by keyword.

    The first parameter of `function` receives the Contacts; its others stay as they are. The
    function of checked contacts remains within reach, as the attribute `of_contacts`.

    Args:
        at_once: a fast way for plain arguments, which gives None for all others
    """
    return _taking(function, ARRAYS, SCALARS, at_once)


def takes_contacts_with_friction(function, at_once=None):
    """The same for a function that knows other shear laws than Coulomb's."""
    return _taking(function, [*_ARRAYS_WITH_FRICTION, SHEAR_STRENGTH], _SCALARS_WITH_LAW, at_once)


_ARRAYS_WITH_FRICTION = [
    n if n.name != "friction_coefficient" else FRICTION_COEFFICIENT for n in ARRAYS
]
_SCALARS_WITH_LAW = [*SCALARS, SHEAR_LAW]
#: Of all arguments of a contact that knows shear laws.
DEFAULTS_WITH_FRICTION = {
    number.name: number.default
    for number in (*_ARRAYS_WITH_FRICTION, SHEAR_STRENGTH, *_SCALARS_WITH_LAW)
}


def complete(function, arguments, defaults):
    """The arguments with the defaults of those that are not given.

    Raises:
        TypeError: as Python's own for a call that does not fit
    """
    complete = {**defaults, **arguments}
    if len(complete) > len(defaults):
        name = next(name for name in arguments if name not in defaults)
        raise unexpected(function, name, defaults)
    missing = [name for name, value in complete.items() if value is REQUIRED]
    if missing:
        raise TypeError(f"{function}() misses the keyword argument {missing[0]!r}")
    return complete


def _annotation(default):
    return "Optional[str]" if default is None else type(default).__name__


def _taking(function, arrays, scalars, at_once=None):
    own = list(inspect.signature(function).parameters.values())[1:]
    contact = [
        inspect.Parameter(
            number.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=number.default,
            annotation=annotation,
        )
        for number, annotation in [
            *((n, "Optional[ArrayLike]" if n.default is None else "ArrayLike") for n in arrays),
            *((n, _annotation(n.default)) for n in scalars),
        ]
    ]
    own_by_keyword = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in own]
    signature = inspect.Signature(
        contact + own_by_keyword, return_annotation=inspect.signature(function).return_annotation
    )
    defaults = {name: parameter.default for name, parameter in signature.parameters.items()}
    own_names = [parameter.name for parameter in own]

    @functools.wraps(function)
    def of_numbers(**arguments):
        if at_once is not None:
            answer = at_once(arguments)
            if answer is not None:
                return answer
        given = complete(function.__name__, arguments, defaults)
        contacts = Contacts.of(function.__name__, given)
        return function(contacts, **{name: given[name] for name in own_names})

    of_numbers.of_contacts = function
    of_numbers.__signature__ = signature
    of_numbers.__doc__ = inspect.cleandoc(function.__doc__) + "\n" + _documented(arrays, scalars)
    del of_numbers.__wrapped__
    return of_numbers
