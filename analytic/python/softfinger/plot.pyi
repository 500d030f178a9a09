# Written by analytic/python/tools/write_stubs.py; do not edit.
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

from softfinger import Calibration, FrictionEllipsoid, LimitSurface, ShearSurface

def plot_contact(
    *,
    normal_force_N: ArrayLike,
    youngs_modulus_Pa: ArrayLike,
    poisson_ratio: ArrayLike,
    thickness_m: ArrayLike,
    radius_major_m: ArrayLike,
    radius_minor_m: ArrayLike,
    friction_coefficient: Optional[ArrayLike] = ...,
    finger_xx_per_m: ArrayLike = ...,
    finger_yy_per_m: ArrayLike = ...,
    finger_xy_per_m: ArrayLike = ...,
    object_thickness_m: ArrayLike = ...,
    object_youngs_modulus_Pa: ArrayLike = ...,
    object_poisson_ratio: ArrayLike = ...,
    shear_strength_Pa: Optional[ArrayLike] = ...,
    pressing: Optional[str] = ...,
    is_object_spherical: bool = ...,
    winkler_modulus: str = ...,
    power_law_coefficient: float = ...,
    power_law_exponent: float = ...,
    power_law_pressure_exponent: float = ...,
    shear_law: str = ...,
    model: Optional[str] = ...,
    axes: Any = ...,
) -> Any: ...
def plot_limit_surface(
    limit: Union[LimitSurface, ShearSurface, FrictionEllipsoid],
    direction_rad: float = ...,
    axes: Any = ...,
    count: int = ...,
    **style: Any,
) -> Any: ...
def plot_calibration(found: Calibration, axes: Any = ...) -> Any: ...
