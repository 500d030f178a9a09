"""What softfinger raises."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """A value from outside that cannot be used.

    The message is one line, "<function>: <argument> = <value>: allowed: <allowed>".

    Attributes:
        function: what refused it
        argument: its name, with the index of the element in an array: "poisson_ratio[3]"
        value: the offending value
        allowed: what would have been accepted, in words
    """

    function: str
    argument: str
    value: Any
    allowed: str

    def __init__(self, function: str, argument: str, value: Any = None, allowed: str = ""):
        super().__init__(function, argument, value, allowed)
        self.function = function
        self.argument = argument
        self.value = value
        self.allowed = allowed

    def __str__(self):
        value = "" if self.value is None else f" = {self.value!r}"
        allowed = f": allowed: {self.allowed}" if self.allowed else ""
        return f"{self.function}: {self.argument}{value}{allowed}"

    @classmethod
    def of_core(cls, function, argument, value, allowed):
        """As the compiled part throws it: the value as text, empty for none."""
        try:
            value = float(value)
        except ValueError:
            value = value or None
        return cls(function, argument, value, allowed)

    @classmethod
    def told(cls, line):
        """As the program tells it, "<where>: <what>"."""
        where, _, what = line.partition(": ")
        return cls(where, what)


class NoAnswer(InputError):
    """A model has no answer, or no derivatives, for a single contact. The message says why.

    Arrays of contacts are masked in its place: see `Prediction`.

    Attributes:
        function: what was asked
        argument: "model"
        value: the model's name
        reason: why, and what to do
    """

    @property
    def reason(self) -> str:
        return self.allowed

    def __str__(self):
        return f"{self.function}: {self.argument} = {self.value!r} has no answer: {self.reason}"


class ProgramError(RuntimeError):
    """The program softfinger is missing or failed. The message says what to do, or what it said."""
