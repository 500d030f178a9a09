"""Figures of contacts and friction limits. Needs matplotlib (Debian: python3-matplotlib), which is
imported when a figure is drawn."""

from __future__ import annotations

from typing import Any, Union

import numpy

from ._contacts import takes_contacts
from ._errors import InputError
from ._friction import FrictionEllipsoid, LimitSurface
from ._predict import predict, pressure_Pa


def _axes(axes):
    if axes is not None:
        return axes
    try:
        import matplotlib.pyplot
    except ImportError as missing:
        raise ImportError(
            "softfinger.plot needs matplotlib (Debian: python3-matplotlib)"
        ) from missing
    return matplotlib.pyplot.subplots()[1]


@takes_contacts
def plot_contact(contacts, model: str = "fingertip_layer", axes: Any = None) -> Any:
    """Draws contact ellipse and pressure of one contact, in mm and kPa at equal scale.

    Args:
        model: a name out of `models()`
        axes: matplotlib axes to draw into; default: a new figure

    Returns:
        the axes

    Raises:
        ImportError: matplotlib is not installed
    """
    contacts.require_single("plot_contact", "call it for each")
    prediction = predict.of_contacts(contacts, model)
    if not prediction.has_answer:
        raise InputError(
            "plot_contact", "model", model, "a model with an answer; `checks` tells why not"
        )
    axes = _axes(axes)
    span = 1.2 * prediction.a_m * numpy.linspace(-1, 1, 161)
    x, y = numpy.meshgrid(span, span)
    pressure = pressure_Pa.of_contacts(contacts, x, y, model)
    drawn = axes.pcolormesh(1e3 * x, 1e3 * y, 1e-3 * pressure, shading="auto", cmap="viridis")
    axes.figure.colorbar(drawn, ax=axes, label="pressure (kPa)")
    turn = numpy.linspace(0, 2 * numpy.pi, 181)
    axes.plot(
        1e3 * prediction.a_m * numpy.cos(turn),
        1e3 * prediction.b_m * numpy.sin(turn),
        color="white",
        linewidth=1,
    )
    axes.set_aspect("equal")
    axes.set_xlabel("x (mm), along the long axis")
    axes.set_ylabel("y (mm)")
    axes.set_title(
        f"{model}: a = {1e3 * prediction.a_m:.3g} mm, b = {1e3 * prediction.b_m:.3g} mm, "
        f"largest torque {1e3 * prediction.max_torque_Nm:.3g} mN·m"
    )
    return axes


def plot_limit_surface(
    limit: Union[LimitSurface, FrictionEllipsoid],
    direction_rad: float = 0.0,
    axes: Any = None,
    count: int = 181,
    **style: Any,
) -> Any:
    """Draws the section of a friction limit by the plane of one direction of tangential force.

    Args:
        limit: a LimitSurface or a FrictionEllipsoid
        direction_rad: of the force, from the contact's long axis
        axes: matplotlib axes to draw into; default: a new figure
        count: of points
        style: of the curve, as matplotlib's plot takes it

    Returns:
        the axes

    Raises:
        ImportError: matplotlib is not installed
    """
    if not isinstance(limit, (LimitSurface, FrictionEllipsoid)):
        raise InputError(
            "plot_limit_surface", "limit", limit, "a LimitSurface or a FrictionEllipsoid"
        )
    points = limit.sample_section(direction_rad, count)
    axes = _axes(axes)
    force = points[:, 0] * numpy.cos(direction_rad) + points[:, 1] * numpy.sin(direction_rad)
    style.setdefault("label", "exact" if isinstance(limit, LimitSurface) else "ellipsoid")
    axes.plot(
        numpy.append(force, force[0]), 1e3 * numpy.append(points[:, 2], points[0, 2]), **style
    )
    axes.set_xlabel("tangential force (N)")
    axes.set_ylabel("torque (mN·m)")
    axes.legend()
    return axes
