"""Finite elements, by the program `softfinger` where it is installed."""

from __future__ import annotations

import dataclasses
import os
import tempfile
from typing import Optional, Union

from ._accuracy import QUANTITIES, Errors
from ._program import input_file, run_program
from ._result import Result


@dataclasses.dataclass(frozen=True, eq=False)
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
    case: Union[str, os.PathLike, dict],
    *,
    level: Optional[int] = None,
    torsion: bool = False,
    limit_surface: Optional[int] = None,
    approach_m: Optional[float] = None,
    output: Union[None, str, os.PathLike] = None,
    time_limit_s: Optional[float] = None,
) -> tuple[FemResult, ...]:
    """Runs `softfinger fem CASE --json`: seconds to minutes. Other threads run meanwhile.

    Args:
        case: name of a built-in case, path of a case file (TOML), or a dict with the tables of one:
            {"geometry": {"relative_radii_mm": [20, 5]}, "layer": {"thickness_mm": 2,
            "youngs_modulus_kPa": 300, "poisson_ratio": 0.45},
            "contact": {"load_N": [2.0], "friction_coefficient": 0.8}}
        level: refinement, 1 (coarse) to 3 (fine); default: the case's own, else 2
        torsion: also twist to full slip: document["twist"]
        limit_surface: number of points of full slip: document["limit_surface"]
        approach_m: press by this approach in place of the case's loads
        output: folder for VTU files
        time_limit_s: of one finite-element problem; default: an hour

    Returns:
        tuple of FemResult, one per load

    Raises:
        InputError: the program refuses the case or an argument; its line is the message
        ProgramError: the program is missing (the message says how to get it), or failed
    """
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
        document = run_program(["fem", input_file(case, folder), *arguments, "--json"])
    return tuple(_result(result) for result in document["results"])


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
