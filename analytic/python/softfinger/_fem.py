"""Finite elements, by the program `softfinger` where it is installed."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Optional, Union

import numpy
from numpy.typing import ArrayLike

from ._accuracy import QUANTITIES, Errors
from ._contacts import DEFAULTS_WITH_FRICTION, Contacts, complete
from ._errors import InputError
from ._program import input_file, run_program
from ._result import Result, result


@result
class FemResult(Result):
    """Finite elements of one load, and the error that they state themselves."""

    load_N: float
    a_m: float
    b_m: float
    indentation_m: float
    area_m2: float  #: seen along the load
    peak_pressure_Pa: float
    max_torque_Nm: float
    error: Errors  #: relative, estimated by the finite elements; None where not known
    document: dict  #: all that the program says: fields of `softfinger fem --json`


def fem(
    case: Union[None, str, os.PathLike, dict] = None,
    *,
    level: Optional[int] = None,
    torsion: bool = False,
    limit_surface: Optional[int] = None,
    approach_m: Optional[float] = None,
    output: Union[None, str, os.PathLike] = None,
    time_limit_s: Optional[float] = None,
    **contact: ArrayLike,
) -> tuple[FemResult, ...]:
    """Runs `softfinger fem CASE --json`: seconds to minutes. Other threads run meanwhile.

        softfinger.fem(**pad, normal_force_N=[1.0, 2.0])  # the arguments of predict
        softfinger.fem("hertz_circle", level=1)           # a case of the program

    Args:
        case: name of a built-in case, path of a case file (TOML), or a dict with the tables of one:
            {"geometry": {"relative_radii_mm": [20, 5]}, "layer": {"thickness_mm": 2,
            "youngs_modulus_kPa": 300, "poisson_ratio": 0.45},
            "contact": {"load_N": [2.0], "friction_coefficient": 0.8}}
        contact: in place of a case, the arguments of `predict`, which has their units and ranges.
            Only the load may be an array; what is for single models is left out
        level: refinement, 1 (coarse) to 3 (fine); default: the case's own, else 2
        torsion: also twist to full slip: document["twist"]
        limit_surface: number of points of full slip: document["limit_surface"]
        approach_m: press by this approach in place of the case's loads
        output: folder for VTU files
        time_limit_s: of one finite-element problem; default: an hour

    Returns:
        tuple of FemResult, one per load

    Raises:
        InputError: an argument is out of its range, or the program refuses the case or an argument;
            its line is the message
        ProgramError: the program is missing (the message says how to get it), or failed
    """
    if case is not None and contact:
        raise InputError("fem", next(iter(contact)), None, "either a case or the numbers of one")
    described = _case_of(contact) if case is None else case
    arguments = []
    for flag, value in (
        ("--level", level),
        ("--limit-surface", limit_surface),
        ("--fem-time-s", time_limit_s),
        ("--output", output),
    ):
        if value is not None:
            arguments += [flag, str(value)]
    if approach_m is not None:
        arguments += ["--approach-mm", repr(1e3 * approach_m)]
    if torsion:
        arguments.append("--torsion")
    with tempfile.TemporaryDirectory() as folder:
        document = run_program(["fem", input_file(described, folder), *arguments, "--json"])
    return tuple(_result(result) for result in document["results"])


def _case_of(arguments: dict[str, Any]):
    """The tables of a case with the arguments of `predict`."""
    given = complete("fem", arguments, DEFAULTS_WITH_FRICTION)
    numbers = Contacts.of("fem", given).numbers
    for name, value in given.items():
        if name != "normal_force_N" and numpy.ndim(value):
            raise InputError("fem", name, value, "one number: only the load may be an array")
    one = {
        name: float(values[0])
        for name, values in numbers.items()
        if isinstance(values, numpy.ndarray) and values.size
    }
    if not one:
        raise InputError("fem", "normal_force_N", given["normal_force_N"], "at least one load")
    law = given["shear_law"]
    contact = {"load_N": numbers["normal_force_N"], "shear_law": law}
    if given["pressing"] is not None:
        contact["pressing"] = given["pressing"]
    if law != "shear_strength":
        contact["friction_coefficient"] = one["friction_coefficient"]
    if law != "coulomb":
        contact["shear_strength_kPa"] = 1e-3 * one["shear_strength_Pa"]
    case = {"geometry": _bodies(one, given["is_object_spherical"]), "layer": _layer(one, "")}
    if one["object_thickness_m"] > 0:
        case["object_layer"] = _layer(one, "object_")
    return {**case, "contact": contact}


def _layer(one, whose):
    return {
        "thickness_mm": 1e3 * one[whose + "thickness_m"],
        "youngs_modulus_kPa": 1e-3 * one[whose + "youngs_modulus_Pa"],
        "poisson_ratio": one[whose + "poisson_ratio"],
    }


def _bodies(one, is_object_spherical):
    """The finger's own curvature, and what is left of the relative one for the object."""
    relative = numpy.diag([1 / one["radius_major_m"], 1 / one["radius_minor_m"]])
    xy = one["finger_xy_per_m"]
    finger = numpy.array([[one["finger_xx_per_m"], xy], [xy, one["finger_yy_per_m"]]])
    if not finger.any() and not is_object_spherical:
        return {"relative_radii_mm": [1e3 * one["radius_major_m"], 1e3 * one["radius_minor_m"]]}
    object_part = relative - finger
    # What is left by rounding of two equal curvatures is a flat direction.
    object_part[abs(object_part) < 1e-12 * relative.max()] = 0
    finger_radii, finger_axis = _principal(finger)
    object_radii, object_axis = _principal(object_part)
    body = {"radii_mm": object_radii}
    if is_object_spherical:
        if not numpy.isclose(*object_radii, rtol=1e-9) or not 0 < object_radii[0] < numpy.inf:
            raise InputError("fem", "is_object_spherical", True, "an object with two equal radii")
        body = {"sphere_radius_mm": object_radii[0]}
    angle = numpy.degrees(object_axis - finger_axis)
    return {"finger": {"radii_mm": finger_radii}, "object": body, "angle_deg": angle}


def _principal(curvature):
    """Radii in mm, infinite ones along flat directions, and the angle of the first."""
    (first, second), axes = numpy.linalg.eigh(curvature)
    with numpy.errstate(divide="ignore"):
        radii = [float(1e3 / k) if k else numpy.inf for k in (first, second)]
    return radii, float(numpy.arctan2(axes[1, 0], axes[0, 0]))


def _result(document):
    error = {quantity: document["error"].get(quantity) for quantity in QUANTITIES}
    return FemResult(
        document["load_N"],
        document["a_m"],
        document["b_m"],
        document["indentation_m"],
        document["area_projected_m2"],
        document["peak_pressure_Pa"],
        document["max_torque_Nm"],
        Errors(**error),
        document,
    )
