"""Finite elements, by the program `softfinger` where it is installed."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Optional, Union

from ._result import Result
from ._accuracy import QUANTITIES, Errors
from ._errors import InputError, ProgramError

_HOW_TO_GET_IT = (
    "the program softfinger is not installed: this package holds the analytic models alone. "
    "Build it on Debian 12 from the sources with `comparisons/run.sh`, then put build/release/bin "
    "into PATH, or name the program in the environment variable SOFTFINGER_PROGRAM"
)


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
        name = str(case)
        if isinstance(case, dict):
            name = os.path.join(folder, "case.toml")
            text = _toml({"id": "from_python", "question": "asked from Python", **case})
            pathlib.Path(name).write_text(text, encoding="utf-8")
        document = run_program(["fem", name, *arguments, "--json"])
    return tuple(_result(result) for result in document["results"])


def find_program() -> str:
    """Path of the program `softfinger`: that in SOFTFINGER_PROGRAM, else the first one in PATH.

    Raises:
        ProgramError: there is none; the message says how to get it
    """
    named = os.environ.get("SOFTFINGER_PROGRAM")
    found = shutil.which(named or "softfinger")
    if found is None:
        raise ProgramError(
            f"SOFTFINGER_PROGRAM = {named!r} is no program" if named else _HOW_TO_GET_IT
        )
    return found


def run_program(arguments):
    """What the program `softfinger` writes to its output with these arguments, as JSON."""
    run = subprocess.run([find_program(), *arguments], capture_output=True, text=True, check=False)
    if run.returncode == 0:
        return json.loads(run.stdout)
    lines = run.stderr.strip().splitlines() or [f"exit status {run.returncode}"]
    if run.returncode == 2:  # by the program's own convention: bad input, told in one line
        raise InputError.told(lines[-1].removeprefix("softfinger: error: "))
    raise ProgramError(lines[-1])


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


def _toml(tables):
    """A case file with these tables."""
    head = "".join(
        f"{key} = {_toml_value(key, value)}\n"
        for key, value in tables.items()
        if not isinstance(value, dict)
    )
    return head + "".join(
        f"[{name}]\n"
        + "".join(f"{key} = {_toml_value(key, value)}\n" for key, value in table.items())
        for name, table in tables.items()
        if isinstance(table, dict)
    )


def _toml_value(key, value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str) or isinstance(value, os.PathLike):
        return json.dumps(os.fspath(value))
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {_toml_value(k, v)}" for k, v in value.items()) + " }"
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml_value(key, one) for one in value) + "]"
    if isinstance(value, (int, float)):
        return repr(value) if not math.isinf(value) else "inf" if value > 0 else "-inf"
    raise InputError("fem", key, value, "numbers, texts, lists and tables")
