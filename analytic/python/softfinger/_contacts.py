"""The numbers of a contact: names, ranges and defaults, for all functions that take a contact."""

import dataclasses
import functools
import inspect

import numpy

from . import _core
from ._errors import InputError

REQUIRED = inspect.Parameter.empty


@dataclasses.dataclass(frozen=True)
class Range:
    holds: object  # of an array, elementwise
    allowed: str


POSITIVE = Range(lambda x: (x > 0) & (x < numpy.inf), "positive and finite")
NOT_NEGATIVE = Range(lambda x: (x >= 0) & (x < numpy.inf), "finite and not negative")
FINITE = Range(numpy.isfinite, "finite")
POISSON = Range(lambda x: (x >= 0) & (x <= 0.5), "0 to 0.5")
EXPONENT = Range(lambda x: (x > 0) & (x < 1), "between 0 and 1, both excluded")
AT_LEAST_ONE = Range(lambda x: (x >= 1) & (x < numpy.inf), "1 or more, finite")


@dataclasses.dataclass(frozen=True)
class Number:
    name: str
    range: Range
    default: object
    meaning: str


# Broadcast against each other.
ARRAYS = (
    Number("normal_force_N", POSITIVE, REQUIRED, "load P"),
    Number("youngs_modulus_Pa", POSITIVE, REQUIRED, "E of the layer"),
    Number("poisson_ratio", POISSON, REQUIRED, "nu of the layer"),
    Number("thickness_m", POSITIVE, REQUIRED, "h of the layer"),
    Number("radius_major_m", POSITIVE, REQUIRED, "R', the longer relative radius of curvature"),
    Number("radius_minor_m", POSITIVE, REQUIRED, "R'', at most R'"),
    Number("friction_coefficient", NOT_NEGATIVE, REQUIRED, "mu"),
    Number(
        "finger_xx_per_m",
        FINITE,
        0.0,
        "the finger's own curvature along the contact's long axis; 0: a flat layer",
    ),
    Number("finger_yy_per_m", FINITE, 0.0, "the same along its short axis"),
    Number("finger_xy_per_m", FINITE, 0.0, "its twist"),
    Number("object_thickness_m", NOT_NEGATIVE, 0.0, "of a layer on the object; 0: a rigid object"),
    Number("object_youngs_modulus_Pa", NOT_NEGATIVE, 0.0, "of that layer"),
    Number("object_poisson_ratio", POISSON, 0.0, "of that layer"),
)
# For all contacts of a call. The last four are for single models.
SCALARS = (
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


def model_card_names():
    return [card["name"] for card in _core.models()]


def check_model(function, name):
    known = model_card_names()
    if name not in known:
        raise InputError(function, "model", name, ", ".join(known))
    return name


def as_numbers(function, name, value):
    """An array of doubles."""
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
        raise InputError(function, "shear_law", law, ", ".join(SHEAR_LAWS))
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


def refuse_first(function, name, values, inside, allowed):
    index = numpy.unravel_index(numpy.argmin(inside), numpy.shape(inside))
    place = "[" + ", ".join(str(int(i)) for i in index) + "]" if index else ""
    raise InputError(function, name + place, float(values[index]), allowed)


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
    return shape, {
        name: numpy.ascontiguousarray(numpy.broadcast_to(array, shape)).reshape(-1)
        for name, array in arrays.items()
    }


@dataclasses.dataclass(frozen=True)
class Contacts:
    """Checked contacts, as the compiled part takes them."""

    shape: tuple
    numbers: dict  # flat arrays and scalars by name

    @classmethod
    def of(cls, function, arguments):
        """Of the arguments by name; `shear_law` with its numbers may be among them."""
        numbers = ARRAYS
        if "shear_law" in arguments:
            numbers = ARRAYS + (SHEAR_STRENGTH,)
            friction = friction_of(
                function,
                arguments["shear_law"],
                arguments["friction_coefficient"],
                arguments["shear_strength_Pa"],
            )
            names = ("friction_coefficient", "shear_strength_Pa")
            arguments = {**arguments, **dict(zip(names, friction))}
        arrays = {}
        for number in numbers:
            arrays[number.name] = as_numbers(function, number.name, arguments[number.name])
            check_range(function, number.name, arrays[number.name], number.range)
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
        for number in SCALARS:
            value = arguments[number.name]
            if number.range is not None:
                array = as_numbers(function, number.name, value)
                if array.shape:
                    raise InputError(function, number.name, value, "one number for all contacts")
                check_range(function, number.name, array, number.range)
                value = float(array)
            flat[number.name] = value
        flat["shear_law"] = arguments.get("shear_law", "coulomb")
        if flat["winkler_modulus"] not in ("oedometric", "youngs"):
            raise InputError(
                function, "winkler_modulus", flat["winkler_modulus"], "'oedometric' or 'youngs'"
            )
        if not isinstance(flat["is_object_spherical"], (bool, numpy.bool_)):
            raise InputError(
                function, "is_object_spherical", flat["is_object_spherical"], "True or False"
            )
        return cls(shape, flat)

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


def takes_contacts(function):
    """Makes a function of checked contacts one of the numbers of contacts, by keyword.

    The first parameter of `function` receives the Contacts; its others stay as they are. The
    function of checked contacts remains within reach, as the attribute `of_contacts`.
    """
    return _taking(function, ARRAYS, SCALARS)


def takes_contacts_with_friction(function):
    """The same for a function that knows other shear laws than Coulomb's."""
    arrays = [n if n.name != "friction_coefficient" else FRICTION_COEFFICIENT for n in ARRAYS]
    return _taking(function, [*arrays, SHEAR_STRENGTH], [*SCALARS, SHEAR_LAW])


def _taking(function, arrays, scalars):
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
            *((n, type(n.default).__name__) for n in scalars),
        ]
    ]
    own_by_keyword = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in own]
    signature = inspect.Signature(
        contact + own_by_keyword, return_annotation=inspect.signature(function).return_annotation
    )

    @functools.wraps(function)
    def of_numbers(**arguments):
        try:
            bound = signature.bind(**arguments)
        except TypeError as wrong:
            raise TypeError(f"{function.__name__}() {wrong}") from None
        bound.apply_defaults()
        contacts = Contacts.of(function.__name__, bound.arguments)
        return function(contacts, **{p.name: bound.arguments[p.name] for p in own})

    of_numbers.of_contacts = function
    of_numbers.__signature__ = signature
    of_numbers.__doc__ = inspect.cleandoc(function.__doc__) + "\n" + _documented(arrays, scalars)
    del of_numbers.__wrapped__
    return of_numbers
