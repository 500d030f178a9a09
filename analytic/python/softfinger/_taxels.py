"""What a tactile array on or inside of the layer reads."""

from __future__ import annotations

from typing import Optional

import numpy

from . import _core
from ._contacts import NOT_NEGATIVE, POSITIVE, as_numbers, check_range, single_model, takes_contacts
from ._errors import InputError
from ._predict import no_answer
from ._result import Result, result


@result
class TaxelReadings(Result):
    """Readings of an array of square taxels: arrays of shape (rows, columns). The array's centre is
    the contact's, x runs along the contact's long axis."""

    model: str  #: whose pressure it is
    x_m: numpy.ndarray  #: middles of the columns
    y_m: numpy.ndarray  #: middles of the rows
    pitch_m: float  #: side of a taxel
    depth_m: float  #: below the layer's surface
    force_N: numpy.ndarray  #: normal, compression positive
    pressure_Pa: numpy.ndarray  #: the same per area
    shear_x_Pa: numpy.ndarray  #: on what lies below; 0 on the surface
    shear_y_Pa: numpy.ndarray
    displacement_m: numpy.ndarray  #: of the surface above the taxel, into the layer
    load_N: float
    outside_N: float  #: force that passes beside the array
    shown_a_m: float  #: as the array shows it, by the second moment of forces in the taxels' middles
    shown_b_m: float
    shown_torque_arm_m: float  #: sum r f / sum f

    def arrays(self) -> dict[str, numpy.ndarray]:
        """All numbers by name, for `numpy.savez(file, **readings.arrays())`."""
        return {name: numpy.asarray(value) for name, value in vars(self).items()}


@takes_contacts
def taxels(
    contacts,
    columns: int,
    rows: int,
    pitch_m: Optional[float] = None,
    depth_m: float = 0.0,
    model: Optional[str] = None,
) -> TaxelReadings:
    """Normal force, pressure, shear and displacement that a tactile array reads under one contact.

    The forces add up to the load over the contact, at depth over the infinite plane. At depth, and
    for the displacement, the layer is flat, on a rigid base, and linearly elastic, whichever model
    the pressure is from.

    Args:
        columns, rows: number of taxels along the contact's long and short axis, 1 to 64
        pitch_m: side of a taxel; default: the array covers the contact and a taxel on each side, at
            depth two depths more
        depth_m: of the array below the layer's surface, 0 to the layer's thickness
        model: a name out of `models()`; default: the recommended one

    Returns:
        TaxelReadings

    Raises:
        NoAnswer: the model has none for this contact
    """
    contacts.require_single("taxels", "call it for each")
    model = single_model("taxels", contacts, model)
    counts = [_whole("columns", columns), _whole("rows", rows)]
    pitch = None if pitch_m is None else _number("pitch_m", pitch_m, POSITIVE)
    depth = _number("depth_m", depth_m, NOT_NEGATIVE)
    fields = _core.taxels(model, contacts.numbers, *counts, pitch, depth)
    if fields is None:
        raise no_answer("taxels", contacts, model)
    return TaxelReadings(model, **fields)


def _whole(name, value):
    if isinstance(value, bool) or not isinstance(value, (int, numpy.integer)):
        raise InputError("taxels", name, value, "a whole number from 1 to 64")
    if not 1 <= value <= 64:
        raise InputError("taxels", name, int(value), "1 to 64")
    return int(value)


def _number(name, value, allowed):
    number = as_numbers("taxels", name, value)
    if number.shape:
        raise InputError("taxels", name, value, "one number")
    check_range("taxels", name, number, allowed)
    return float(number)
