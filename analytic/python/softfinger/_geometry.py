"""Local geometry: triangles to radii of curvature, and two bodies to the gap between them."""

from __future__ import annotations

import dataclasses
from typing import Optional, Union

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import FINITE, POSITIVE, Range, as_numbers, broadcast, check_range
from ._errors import InputError
from ._names import suggests_keywords
from ._result import Numbers, Result, result, shaped

Curvature = Union[ArrayLike, tuple[ArrayLike, ArrayLike], "QuadricFit"]

_RADIUS = Range(lambda r: ~numpy.isnan(r) & (r != 0), "not zero; infinite: flat, negative: hollow")


@result
class QuadricFit(Result):
    """Least-squares quadric, depth = A x² + B y² + C x y below the tangent plane, of a surface near
    a point. A convex body has positive radii; infinite ones are flat, negative ones hollow."""

    A_per_m: float
    B_per_m: float
    C_per_m: float
    covariance_per_m2: numpy.ndarray  #: (3, 3), of (A, B, C)
    radii_m: numpy.ndarray  #: (2,), principal; the first belongs to the smallest curvature
    axis_rad: float  #: the direction of radii_m[0], counter-clockwise from x_axis
    radii_std_m: numpy.ndarray  #: (2,), one standard deviation
    radii_region_change_m: numpy.ndarray  #: (2,), over regions of 0.8 and 1.25 times the radius
    origin_m: numpy.ndarray  #: (3,), on the fitted surface, nearest to the given point
    normal: numpy.ndarray  #: (3,), outward unit normal there
    x_axis: numpy.ndarray  #: (3,), the projection of the global x axis, or y near x
    residual_rms_m: float  #: between facets and quadric
    region_radius_m: float
    area_m2: float  #: of the surface region used
    points: int  #: vertices within the region
    outliers: int  #: spikes left out
    has_sharp_edge: bool  #: radii say little about a contact at an edge
    sharpest_kink_rad: float


@suggests_keywords
def weld(corners_m: ArrayLike) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Triangles as STL files hold them, with equal corners made one vertex.

    Args:
        corners_m: (m, 3, 3), three corners of each triangle

    Returns:
        vertices_m (n, 3), triangles (m', 3) of indices; those with two equal corners are left out
    """
    corners = as_numbers("weld", "corners_m", corners_m)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3):
        raise InputError("weld", "corners_m", f"array of shape {corners.shape}", "shape (m, 3, 3)")
    vertices, index = numpy.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    a, b, c = triangles.T
    return vertices, triangles[(a != b) & (b != c) & (c != a)]


@suggests_keywords
def fit(
    surface: Union[ArrayLike, tuple[ArrayLike, ArrayLike]],
    point_m: ArrayLike,
    region_radius_m: float,
    outward_normal: Optional[ArrayLike] = None,
) -> QuadricFit:
    """Fits a quadric to the connected part of a triangulated surface around a point.

    Minimises the integral of (depth of the facets - quadric)² over the region (Ciocarlie et al.
    2007, eq. 7), with tilt and offset estimated too and spikes left out. A few ms for 5,000
    triangles. Other threads run meanwhile.

    Args:
        surface: corners (m, 3, 3) in m, or a pair (vertices_m (n, 3), triangles (m, 3) of indices);
            triangles are counter-clockwise seen from outside
        point_m: (3,), where it will be touched
        region_radius_m: positive and finite. Twice the area of the expected contact is right.
        outward_normal: (3,), tells outside from inside; default: the triangles do

    Returns:
        QuadricFit

    Raises:
        InputError: an argument cannot be used, or the region has fewer than six vertices
        RuntimeError: the region is too strongly curved for one quadric
    """
    vertices, triangles = surface if isinstance(surface, (tuple, list)) else weld(surface)
    vertices = as_numbers("fit", "vertices_m", vertices)
    triangles = numpy.asarray(triangles)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InputError("fit", "vertices_m", f"array of shape {vertices.shape}", "shape (n, 3)")
    check_range("fit", "vertices_m", vertices, FINITE)
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "ui":
        raise InputError(
            "fit",
            "triangles",
            f"{triangles.dtype} array of shape {triangles.shape}",
            "whole numbers of shape (m, 3)",
        )
    check_range(
        "fit",
        "triangles",
        triangles,
        Range(lambda i: (i >= 0) & (i < len(vertices)), f"0 to {len(vertices) - 1}"),
    )
    radius = as_numbers("fit", "region_radius_m", region_radius_m)
    check_range("fit", "region_radius_m", radius, POSITIVE)
    normal = None if outward_normal is None else _vector("outward_normal", outward_normal)
    return QuadricFit(
        **_core.fit(
            numpy.ascontiguousarray(vertices),
            numpy.ascontiguousarray(triangles, dtype=numpy.intc),
            _vector("point_m", point_m),
            normal,
            float(radius),
        )
    )


def _vector(name, value):
    vector = as_numbers("fit", name, value)
    if vector.shape != (3,):
        raise InputError("fit", name, f"array of shape {vector.shape}", "shape (3,)")
    check_range("fit", name, vector, FINITE)
    return vector


@result
class Gap(Result):
    """The gap x²/(2 R') + y²/(2 R'') between two bodies, and the finger's part of it."""

    radius_major_m: Numbers  #: R'
    radius_minor_m: Numbers  #: R''
    axis_rad: Numbers  #: of the contact's long axis, from the finger's x axis
    finger_xx_per_m: Numbers
    finger_yy_per_m: Numbers
    finger_xy_per_m: Numbers

    def arguments(self) -> dict[str, Numbers]:
        """As keywords of the functions of contacts: predict(**gap.arguments(), ..)."""
        names = (f.name for f in dataclasses.fields(self) if f.name != "axis_rad")
        return {name: getattr(self, name) for name in names}


@suggests_keywords
def gap_between(
    finger: Curvature, object: Curvature = numpy.inf, angle_rad: ArrayLike = 0.0
) -> Gap:
    """The gap between a finger and an object that touch, from their radii of curvature (Ciocarlie
    et al. 2007, eq. 8).

    Args:
        finger, object: a radius in m (a sphere), a tuple of two principal radii in m along the
            body's own x and y, or a QuadricFit; infinite: flat, negative: hollow. Radii may be
            arrays.
        angle_rad: from the finger's x axis to the object's, counter-clockwise about the finger's
            outward normal; the x axis of a QuadricFit is its x_axis

    Returns:
        Gap

    Raises:
        InputError: an argument cannot be used, or the bodies touch in no ellipse: along a line,
            flat on flat, or a saddle
    """
    function = "gap_between"
    (finger_x, finger_y), finger_axis = _radii(finger, "finger")
    (object_x, object_y), object_axis = _radii(object, "object")
    # An object's own frame looks along its own outward normal: the finger sees it in a mirror.
    angle = as_numbers(function, "angle_rad", angle_rad)
    check_range(function, "angle_rad", angle, FINITE)
    shape, flat = broadcast(
        function,
        {
            "finger_x": finger_x,
            "finger_y": finger_y,
            "object_x": object_x,
            "object_y": object_y,
            "angle_rad": angle - object_axis - finger_axis,
        },
    )
    found = _core.gaps(numpy.stack(list(flat.values()), axis=1))
    if not (found[:, 0] > 0).all():
        first = int(numpy.argmin(found[:, 0] > 0))
        raise InputError(
            function,
            "radii",
            tuple(float(column[first]) for column in list(flat.values())[:4]),
            "bodies that touch in an ellipse, with both relative curvatures positive",
        )
    found[:, 2] += finger_axis
    return Gap(*(shaped(column, shape) for column in found.T))


def _radii(body, name):
    """Principal radii, and the angle of the first from the body's x axis."""
    if isinstance(body, QuadricFit):
        return tuple(numpy.asarray(radius) for radius in body.radii_m), body.axis_rad
    pair = body if isinstance(body, tuple) else (body, body)
    if len(pair) != 2:
        raise InputError(
            "gap_between", name, body, "a radius, a tuple of two radii or a QuadricFit"
        )
    radii = tuple(as_numbers("gap_between", name, radius) for radius in pair)
    for radius in radii:
        check_range("gap_between", name, radius, _RADIUS)
    return radii, 0.0
