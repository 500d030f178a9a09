# Written by analytic/python/tools/write_stubs.py; do not edit.
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike
from typing import NamedTuple

from softfinger import FlatPad

class Bounds(NamedTuple):
    a: Any
    b: Any
    indentation: Any
    area: Any
    peak_pressure: Any
    max_torque: Any

class Contact(NamedTuple):
    a_m: Any
    b_m: Any
    indentation_m: Any
    area_m2: Any
    peak_pressure_Pa: Any
    torque_arm_exact_m: Any
    torque_arm_paper_m: Any
    max_force_N: Any
    max_torque_Nm: Any
    eccentricity_m: Any
    pressure_arm_m: Any
    normal_stiffness_N_per_m: Any

class Pad(NamedTuple):
    indentation_m: Any
    normal_stiffness_N_per_m: Any
    pressure_arm_m: Any
    max_force_N: Any
    max_torque_Nm: Any
    eccentricity_m: Any
    torque_bound: Any

class Sample(NamedTuple):
    youngs_modulus_Pa: Any
    poisson_ratio: Any
    thickness_m: Any
    friction_coefficient: Any
    contact: Contact

class StuckStiffness(NamedTuple):
    torsional_Nm_per_rad: Any
    tangential_x_N_per_m: Any
    tangential_y_N_per_m: Any

def bonded_layer(
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    radius_major_m,
    radius_minor_m,
    friction_coefficient,
    pressing: str = ...,
    with_stiffness: bool = ...,
) -> Contact: ...
def error_bound(
    model: str = ..., is_object_spherical: bool = ..., pressing: str = ..., **contact
) -> Bounds: ...
def fingertip_layer(
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    radius_major_m,
    radius_minor_m,
    friction_coefficient,
    finger_xx_per_m=...,
    finger_yy_per_m=...,
    finger_xy_per_m=...,
    is_object_spherical: bool = ...,
    pressing: str = ...,
    with_stiffness: bool = ...,
) -> Contact: ...
def pad_layer(
    pad: FlatPad,
    *,
    normal_force_N,
    youngs_modulus_Pa,
    poisson_ratio,
    thickness_m,
    friction_coefficient,
    pressing: str = ...,
) -> Pad: ...
def sample(
    count: int,
    seed: int,
    *,
    normal_force_N,
    youngs_modulus_Pa: float,
    poisson_ratio: float,
    thickness_m: float,
    radius_major_m,
    radius_minor_m,
    friction_coefficient: float,
    finger_xx_per_m=...,
    finger_yy_per_m=...,
    finger_xy_per_m=...,
    youngs_modulus_factor: float = ...,
    thickness_factor: float = ...,
    friction_factor: float = ...,
    poisson_ratio_std: float = ...,
    model: str = ...,
) -> Sample: ...
def stuck_stiffness(
    *, a_m, b_m, thickness_m, youngs_modulus_Pa, poisson_ratio
) -> StuckStiffness: ...
def utilisation(max_force_N, eccentricity_m, force_x_N, force_y_N, torque_Nm): ...
