"""The program `softfinger`, which is found and run where it is installed."""

from __future__ import annotations

import json
import math
import os
import pathlib
import shutil
import subprocess

from ._errors import InputError, ProgramError

_HOW_TO_GET_IT = (
    "the program softfinger is not installed: this package holds the analytic models alone. "
    "On Debian 12 install the package softfinger, or build it from the sources with "
    "`comparisons/run.sh` and put build/release/bin into PATH, or name the program in the "
    "environment variable SOFTFINGER_PROGRAM"
)


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
    if run.returncode != 0:
        raise refusal(run.returncode, run.stderr)
    return json.loads(run.stdout)


def refusal(status, told):
    """The error that an exit status and what was told mean."""
    lines = told.strip().splitlines() or [f"exit status {status}"]
    line = lines[-1].removeprefix("softfinger: ").removeprefix("error: ")
    # By the program's own convention: bad input, told in one line.
    return InputError.told(line) if status == 2 else ProgramError(line)


def input_file(described, folder):
    """What the program is told to read: a name or path as it is, a dict as a file in the folder."""
    if not isinstance(described, dict):
        return os.fspath(described)
    path = os.path.join(folder, "from_python.toml")
    text = _toml({"id": "from_python", "question": "asked from Python", **described})
    pathlib.Path(path).write_text(text, encoding="utf-8")
    return path


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
