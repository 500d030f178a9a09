"""Figures of contacts and friction limits. Needs matplotlib (Debian: python3-matplotlib), which is
imported when a figure is drawn."""

from __future__ import annotations

from typing import Any, Optional, Union

import numpy

from ._calibrate import Calibration
from ._contacts import takes_contacts_with_friction
from ._errors import InputError
from ._friction import FrictionEllipsoid, LimitSurface, ShearSurface
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


@takes_contacts_with_friction
def plot_contact(contacts, model: Optional[str] = None, axes: Any = None) -> Any:
    """Draws contact ellipse and pressure of one contact, in mm and kPa at equal scale.

    Args:
        model: a name out of `models()`; default: the recommended one
        axes: matplotlib axes to draw into; default: a new figure

    Returns:
        the axes

    Raises:
        NoAnswer: the model has none for this contact
        ImportError: matplotlib is not installed
    """
    contacts.require_single("plot_contact", "call it for each")
    prediction = predict.of_contacts(contacts, model)
    model = prediction.model
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
        f"{model}: a = {1e3 * prediction.a_m:.3g} mm, b = {1e3 * prediction.b_m:.3g} mm\n"
        f"largest torque {1e3 * prediction.max_torque_Nm:.3g} mN·m"
    )
    return axes


def plot_limit_surface(
    limit: Union[LimitSurface, ShearSurface, FrictionEllipsoid],
    direction_rad: float = 0.0,
    axes: Any = None,
    count: int = 181,
    **style: Any,
) -> Any:
    """Draws the section of a friction limit by the plane of one direction of tangential force.

    Args:
        limit: a LimitSurface, a ShearSurface or a FrictionEllipsoid
        direction_rad: of the force, from the contact's long axis
        axes: matplotlib axes to draw into; default: a new figure
        count: of points
        style: of the curve, as matplotlib's plot takes it

    Returns:
        the axes

    Raises:
        ImportError: matplotlib is not installed
    """
    if not isinstance(limit, (LimitSurface, ShearSurface, FrictionEllipsoid)):
        raise InputError(
            "plot_limit_surface",
            "limit",
            limit,
            "a LimitSurface, a ShearSurface or a FrictionEllipsoid",
        )
    points = limit.sample_section(direction_rad, count)
    axes = _axes(axes)
    force = points[:, 0] * numpy.cos(direction_rad) + points[:, 1] * numpy.sin(direction_rad)
    style.setdefault("label", "ellipsoid" if isinstance(limit, FrictionEllipsoid) else "exact")
    axes.plot(
        numpy.append(force, force[0]), 1e3 * numpy.append(points[:, 2], points[0, 2]), **style
    )
    axes.set_xlabel("tangential force (N)")
    axes.set_ylabel("torque (mN·m)")
    axes.legend()
    return axes


# Names, units and how many of these are one in SI.
_LABELS = {
    "a_m": ("a (mm)", 1e3),
    "b_m": ("b (mm)", 1e3),
    "area_m2": ("area (mm²)", 1e6),
    "indentation_m": ("indentation (mm)", 1e3),
    "max_torque_Nm": ("largest torque (mN·m)", 1e3),
    "tangential_force_N": ("tangential force (N)", 1),
}


def plot_calibration(found: Calibration, axes: Any = None) -> Any:
    """Draws the measured values of a calibration with their standard deviations over the load, the
    fit, where chance leaves the fit itself in 95 % of all cases, and outliers as crosses.

    Args:
        found: what `calibrate` returned
        axes: matplotlib axes to draw into, one for each measured quantity; default: a new figure

    Returns:
        array of the axes, in the order of `found.measured`

    Raises:
        InputError: `found` is no Calibration, or there are other than its number of axes
        ImportError: matplotlib is not installed
    """
    function = "plot_calibration"
    if not isinstance(found, Calibration):
        raise InputError(function, "found", found, "what calibrate returned")
    count = len(found.measured)
    if axes is None:
        first = _axes(None)
        figure = first.figure
        figure.clear()
        figure.set_size_inches(4 * count, 3.5)
        axes = figure.subplots(1, count, squeeze=False)
        figure.set_layout_engine("tight")
    axes = numpy.atleast_1d(axes).reshape(-1)
    if len(axes) != count:
        raise InputError(function, "axes", f"{len(axes)} axes", f"{count}, one for each quantity")
    for one, (quantity, measured) in zip(axes, found.measured.items()):
        label, scale = _LABELS[quantity]
        curve = found.curves[quantity]
        is_outlier = numpy.zeros(measured.shape, bool)
        for outlier in found.outliers:
            if outlier.quantity == quantity:
                is_outlier[outlier.index] = True
        counts = ~is_outlier & ~numpy.ma.getmaskarray(measured)
        one.fill_between(curve.load_N, scale * curve.low, scale * curve.high, alpha=0.25)
        one.plot(curve.load_N, scale * curve.value, label=found.model)
        one.errorbar(
            found.load_N[counts],
            scale * measured[counts],
            scale * found.std[quantity][counts],
            fmt="o",
            color="black",
            label="measured",
        )
        if is_outlier.any():
            one.plot(
                found.load_N[is_outlier],
                scale * measured[is_outlier],
                "x",
                color="red",
                label="left out",
            )
        one.set_xscale("log")
        one.set_yscale("log")
        one.set_xlabel("load (N)")
        one.set_ylabel(label)
        one.legend()
    return axes
