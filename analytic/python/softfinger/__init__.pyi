# Written by analytic/python/tools/write_stubs.py; do not edit.
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

Numbers = Union[float, numpy.ndarray]
Flags = Union[bool, numpy.ndarray]
Words = Union[str, numpy.ndarray]
Curvature = Union[ArrayLike, tuple[ArrayLike, ArrayLike], "QuadricFit"]

__version__: str

class Body:
    name: str
    mass_kg: float
    inertia_kg_m2: ArrayLike
    center_m: ArrayLike
    fixed: bool
    pose: ArrayLike
    velocity_m_per_s: ArrayLike
    angular_velocity_rad_per_s: ArrayLike
    def __init__(self, name: str, mass_kg: float = ..., inertia_kg_m2: ArrayLike = ..., center_m: ArrayLike = ..., fixed: bool = ..., pose: ArrayLike = ..., velocity_m_per_s: ArrayLike = ..., angular_velocity_rad_per_s: ArrayLike = ...) -> None: ...
    @classmethod
    def sphere(cls, name: str, radius_m: float, mass_kg: float, position_m: ArrayLike, **others) -> Body: ...
    @classmethod
    def box(cls, name: str, size_m: ArrayLike, mass_kg: float, position_m: ArrayLike, **others) -> Body: ...
    @classmethod
    def ground(cls, name: str = ...) -> Body: ...

class BoxOnPlane:
    a: str
    b: str
    friction_coefficient: float
    eccentricity_m: Union[float, Callable[[float], float]]
    shape: Optional[tuple[float, float]]
    size_m: ArrayLike
    def __init__(self, a: str, b: str, size_m: ArrayLike, *, friction_coefficient: float, eccentricity_m: Union[float, Callable[[float], float]] = ..., shape: Optional[tuple[float, float]] = ...) -> None: ...
    def find(self, simulation: Simulation) -> Iterable[Contact]: ...

class Calibration:
    model: str
    shear_law: str
    parameters: dict[str, Estimate]
    fixed: dict[str, float]
    covariance: Optional[numpy.ndarray]
    cannot_tell: tuple[str, ...]
    next_measurement: Optional[NextMeasurement]
    models: tuple[ModelFit, ...]
    shear_laws: tuple[ModelFit, ...]
    outliers: tuple[Outlier, ...]
    goodness: Goodness
    growth_exponent: Optional[tuple[float, float]]
    contact: dict[str, Any]
    load_N: numpy.ndarray
    measured: dict[str, numpy.ndarray]
    std: dict[str, numpy.ndarray]
    predicted: dict[str, numpy.ndarray]
    deviation: dict[str, numpy.ndarray]
    curves: dict[str, Curve]
    def __init__(self, model: str, shear_law: str, parameters: dict[str, Estimate], fixed: dict[str, float], covariance: Optional[numpy.ndarray], cannot_tell: tuple[str, ...], next_measurement: Optional[NextMeasurement], models: tuple[ModelFit, ...], shear_laws: tuple[ModelFit, ...], outliers: tuple[Outlier, ...], goodness: Goodness, growth_exponent: Optional[tuple[float, float]], contact: dict[str, Any], load_N: numpy.ndarray, measured: dict[str, numpy.ndarray], std: dict[str, numpy.ndarray], predicted: dict[str, numpy.ndarray], deviation: dict[str, numpy.ndarray], curves: dict[str, Curve]) -> None: ...

class Check:
    name: str
    value: float
    limit: float
    holds: bool
    holds_below: bool
    message: str
    def __init__(self, name: str, value: float, limit: float, holds: bool, holds_below: bool, message: str) -> None: ...

class Choice:
    model: Words
    bound: Numbers
    cost_s: dict[str, float]
    bounds: dict[str, ErrorBound]
    def __init__(self, model: Words, bound: Numbers, cost_s: dict[str, float], bounds: dict[str, ErrorBound]) -> None: ...

class Contact:
    a: str
    b: str
    point_m: ArrayLike
    normal: ArrayLike
    gap_m: float
    friction_coefficient: float
    eccentricity_m: Union[float, Callable[[float], float]]
    id: int
    long_axis: Optional[ArrayLike]
    shape: Optional[tuple[float, float]]
    def __init__(self, a: str, b: str, point_m: ArrayLike, normal: ArrayLike, gap_m: float, friction_coefficient: float, eccentricity_m: Union[float, Callable[[float], float]] = ..., id: int = ..., long_axis: Optional[ArrayLike] = ..., shape: Optional[tuple[float, float]] = ...) -> None: ...

class ContactState:
    a: str
    b: str
    id: int
    point_m: numpy.ndarray
    axes: numpy.ndarray
    gap_m: float
    friction_coefficient: float
    normal_force_N: float
    tangent_force_1_N: float
    tangent_force_2_N: float
    torque_Nm: float
    eccentricity_m: float
    slip_m_per_s: float
    def __init__(self, a: str, b: str, id: int, point_m: numpy.ndarray, axes: numpy.ndarray, gap_m: float, friction_coefficient: float, normal_force_N: float, tangent_force_1_N: float, tangent_force_2_N: float, torque_Nm: float, eccentricity_m: float, slip_m_per_s: float) -> None: ...

class Curve:
    load_N: numpy.ndarray
    value: numpy.ndarray
    low: numpy.ndarray
    high: numpy.ndarray
    def __init__(self, load_N: numpy.ndarray, value: numpy.ndarray, low: numpy.ndarray, high: numpy.ndarray) -> None: ...

class Derivatives:
    normal_force_N: Numbers
    youngs_modulus_Pa: Numbers
    poisson_ratio: Numbers
    thickness_m: Numbers
    radius_major_m: Numbers
    radius_minor_m: Numbers
    finger_xx_per_m: Numbers
    finger_yy_per_m: Numbers
    finger_xy_per_m: Numbers
    friction_coefficient: Numbers
    def __init__(self, normal_force_N: Numbers, youngs_modulus_Pa: Numbers, poisson_ratio: Numbers, thickness_m: Numbers, radius_major_m: Numbers, radius_minor_m: Numbers, finger_xx_per_m: Numbers, finger_yy_per_m: Numbers, finger_xy_per_m: Numbers, friction_coefficient: Numbers) -> None: ...

class ErrorBound:
    model: Words
    known: Flags
    bound: Errors
    expected: Optional[Errors]
    by_model: Optional[Errors]
    by_strain: Optional[Errors]
    by_slope: Optional[Errors]
    by_curvature: Optional[Errors]
    outside: Words
    def __init__(self, model: Words, known: Flags, bound: Errors, expected: Optional[Errors], by_model: Optional[Errors], by_strain: Optional[Errors], by_slope: Optional[Errors], by_curvature: Optional[Errors], outside: Words) -> None: ...
    def usable(self, tolerance: float = ..., quantities: Sequence[str] = ...) -> Flags: ...

class Errors:
    a: Numbers
    b: Numbers
    indentation: Numbers
    area: Numbers
    peak_pressure: Numbers
    max_torque: Numbers
    def __init__(self, a: Numbers, b: Numbers, indentation: Numbers, area: Numbers, peak_pressure: Numbers, max_torque: Numbers) -> None: ...
    def largest(self, quantities: Sequence[str] = ...) -> Numbers: ...

class Estimate:
    name: str
    unit: str
    value: float
    std: float
    interval95: tuple[float, float]
    interval_open: tuple[bool, bool]
    determined: bool
    def __init__(self, name: str, unit: str, value: float, std: float, interval95: tuple[float, float], interval_open: tuple[bool, bool], determined: bool) -> None: ...

class FemResult:
    load_N: float
    a_m: float
    b_m: float
    indentation_m: float
    area_m2: float
    peak_pressure_Pa: float
    max_torque_Nm: float
    error: Errors
    document: dict
    def __init__(self, load_N: float, a_m: float, b_m: float, indentation_m: float, area_m2: float, peak_pressure_Pa: float, max_torque_Nm: float, error: Errors, document: dict) -> None: ...

class FlatPad:
    def __init__(self, _, **__): ...
    @classmethod
    def rectangle(cls, length_m: float, width_m: float, corner_radius_m: float = ...) -> FlatPad: ...
    @classmethod
    def disc(cls, diameter_m: float) -> FlatPad: ...
    @classmethod
    def polygon(cls, points_m: Sequence[Sequence[float]]) -> FlatPad: ...
    @property
    def area_m2(self) -> float: ...
    @property
    def vertices_m(self) -> numpy.ndarray: ...
    def predict(self, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, friction_coefficient: ArrayLike, model: str = ..., pressing: str = ...) -> PadPrediction: ...

class FrictionEllipsoid:
    max_force_N: Numbers
    eccentricity_m: Numbers
    def __init__(self, max_force_N: Numbers, eccentricity_m: Numbers) -> None: ...
    @classmethod
    def of_shear_law(cls, a_m: ArrayLike, b_m: ArrayLike, exponent: ArrayLike, load_N: ArrayLike, shear_law: str = ..., friction_coefficient: Optional[ArrayLike] = ..., shear_strength_Pa: Optional[ArrayLike] = ...) -> FrictionEllipsoid: ...
    @property
    def max_torque_Nm(self) -> Numbers: ...
    def utilisation(self, wrench: ArrayLike) -> Numbers: ...
    def sample_section(self, direction_rad: float, count: int) -> numpy.ndarray: ...

class Gap:
    radius_major_m: Numbers
    radius_minor_m: Numbers
    axis_rad: Numbers
    finger_xx_per_m: Numbers
    finger_yy_per_m: Numbers
    finger_xy_per_m: Numbers
    def __init__(self, radius_major_m: Numbers, radius_minor_m: Numbers, axis_rad: Numbers, finger_xx_per_m: Numbers, finger_yy_per_m: Numbers, finger_xy_per_m: Numbers) -> None: ...
    def arguments(self) -> dict[str, Numbers]: ...

class Goodness:
    probability: Optional[float]
    error_factor: float
    sum_of_squares: float
    degrees_of_freedom: int
    scatter: dict[str, float]
    def __init__(self, probability: Optional[float], error_factor: float, sum_of_squares: float, degrees_of_freedom: int, scatter: dict[str, float]) -> None: ...

class InputError(ValueError):
    function: str
    argument: str
    value: Any
    allowed: str
    def __init__(self, function: str, argument: str, value: Any = ..., allowed: str = ...): ...
    @classmethod
    def of_core(cls, function, argument, value, allowed): ...
    @classmethod
    def told(cls, line): ...

class Joint:
    name: str
    child: str
    kind: str
    parent: Optional[str]
    axis: ArrayLike
    anchor_m: ArrayLike
    start: float
    lower: float
    upper: float
    def __init__(self, name: str, child: str, kind: str, parent: Optional[str] = ..., axis: ArrayLike = ..., anchor_m: ArrayLike = ..., start: float = ..., lower: float = ..., upper: float = ...) -> None: ...

class LimitSurface:
    a_m: float
    b_m: float
    exponent: float
    max_force_N: float
    def __init__(self, a_m: float, b_m: float, exponent: float, max_force_N: float) -> None: ...
    @property
    def eccentricity_m(self) -> float: ...
    @property
    def max_torque_Nm(self) -> Numbers: ...
    def ellipsoid(self) -> FrictionEllipsoid: ...
    def wrench_for_twist(self, twist: ArrayLike) -> numpy.ndarray: ...
    def support(self, twist: ArrayLike) -> Numbers: ...
    def utilisation(self, wrench: ArrayLike) -> Numbers: ...
    def contains(self, wrench: ArrayLike) -> Flags: ...
    def project(self, wrench: ArrayLike) -> numpy.ndarray: ...
    def sample(self, count: int) -> numpy.ndarray: ...
    def sample_section(self, direction_rad: float, count: int) -> numpy.ndarray: ...
    def wrench_for_center_of_rotation(self, center_m: ArrayLike) -> numpy.ndarray: ...

class ModelCard:
    name: str
    title: str
    assumptions: str
    equations: str
    source: str
    validity: str
    cost: str
    is_fast: bool
    has_finite_strain: bool
    knows_pressing_friction: bool
    is_for_several_layers: bool
    def __init__(self, name: str, title: str, assumptions: str, equations: str, source: str, validity: str, cost: str, is_fast: bool, has_finite_strain: bool, knows_pressing_friction: bool, is_for_several_layers: bool) -> None: ...

class ModelFit:
    name: str
    aic: float
    scatter: float
    held_out_error: Optional[float]
    parameters: dict[str, float]
    def __init__(self, name: str, aic: float, scatter: float, held_out_error: Optional[float], parameters: dict[str, float]) -> None: ...

class Motor:
    joint: str
    stiffness: float
    damping: float
    feed_forward: float
    max_effort: float
    target: float
    target_velocity: float
    def __init__(self, joint: str, stiffness: float = ..., damping: float = ..., feed_forward: float = ..., max_effort: float = ..., target: float = ..., target_velocity: float = ...) -> None: ...

class NextMeasurement:
    quantity: str
    load_N: Optional[float]
    relative_std: float
    parameter: str
    std_now: float
    std_then: float
    def __init__(self, quantity: str, load_N: Optional[float], relative_std: float, parameter: str, std_now: float, std_then: float) -> None: ...

class NoAnswer(InputError):
    @property
    def reason(self) -> str: ...

class Outlier:
    quantity: str
    index: tuple[int, ...]
    load_N: float
    measured: float
    predicted: float
    deviation: float
    def __init__(self, quantity: str, index: tuple[int, ...], load_N: float, measured: float, predicted: float, deviation: float) -> None: ...

class PadPrediction:
    has_answer: Flags
    indentation_m: Numbers
    normal_stiffness_N_per_m: Numbers
    peak_pressure_Pa: Numbers
    pressure_arm_m: Numbers
    eccentricity_m: Numbers
    tilt_stiffness_x_Nm_per_rad: Numbers
    tilt_stiffness_y_Nm_per_rad: Numbers
    tilt_limit_x_Nm: Numbers
    tilt_limit_y_Nm: Numbers
    torsional_stiffness_Nm_per_rad: Numbers
    tangential_stiffness_x_N_per_m: Numbers
    tangential_stiffness_y_N_per_m: Numbers
    torque_bound: Numbers
    max_force_N: Numbers
    max_torque_Nm: Numbers
    def __init__(self, has_answer: Flags, indentation_m: Numbers, normal_stiffness_N_per_m: Numbers, peak_pressure_Pa: Numbers, pressure_arm_m: Numbers, eccentricity_m: Numbers, tilt_stiffness_x_Nm_per_rad: Numbers, tilt_stiffness_y_Nm_per_rad: Numbers, tilt_limit_x_Nm: Numbers, tilt_limit_y_Nm: Numbers, torsional_stiffness_Nm_per_rad: Numbers, tangential_stiffness_x_N_per_m: Numbers, tangential_stiffness_y_N_per_m: Numbers, torque_bound: Numbers, max_force_N: Numbers, max_torque_Nm: Numbers) -> None: ...
    def friction_ellipsoid(self) -> FrictionEllipsoid: ...

class Prediction:
    model: Words
    has_answer: Flags
    a_m: Numbers
    b_m: Numbers
    indentation_m: Numbers
    area_m2: Numbers
    peak_pressure_Pa: Numbers
    pressing: Words
    pressure_arm_m: Numbers
    frictionless_a_m: Numbers
    frictionless_b_m: Numbers
    torque_arm_exact_m: Numbers
    torque_arm_paper_m: Numbers
    max_force_N: Numbers
    max_torque_Nm: Numbers
    eccentricity_m: Numbers
    normal_force_N: Numbers
    shear_law: str
    friction_coefficient: Numbers
    shear_strength_Pa: Numbers
    def __init__(self, model: Words, has_answer: Flags, a_m: Numbers, b_m: Numbers, indentation_m: Numbers, area_m2: Numbers, peak_pressure_Pa: Numbers, pressing: Words, pressure_arm_m: Numbers, frictionless_a_m: Numbers, frictionless_b_m: Numbers, torque_arm_exact_m: Numbers, torque_arm_paper_m: Numbers, max_force_N: Numbers, max_torque_Nm: Numbers, eccentricity_m: Numbers, normal_force_N: Numbers, shear_law: str, friction_coefficient: Numbers, shear_strength_Pa: Numbers) -> None: ...
    def friction_ellipsoid(self) -> FrictionEllipsoid: ...
    def limit_surface(self) -> Union[LimitSurface, ShearSurface]: ...

class PredictionWithGradient:
    prediction: Prediction
    known: Flags
    normal_stiffness_N_per_m: Numbers
    torsional_stiffness_Nm_per_rad: Numbers
    tangential_stiffness_x_N_per_m: Numbers
    tangential_stiffness_y_N_per_m: Numbers
    d_a_m: Derivatives
    d_b_m: Derivatives
    d_indentation_m: Derivatives
    d_area_m2: Derivatives
    d_peak_pressure_Pa: Derivatives
    d_pressure_arm_m: Derivatives
    d_torque_arm_exact_m: Derivatives
    d_torque_arm_paper_m: Derivatives
    d_max_torque_Nm: Derivatives
    d_torsional_stiffness_Nm_per_rad: Derivatives
    d_tangential_stiffness_x_N_per_m: Derivatives
    d_tangential_stiffness_y_N_per_m: Derivatives
    def __init__(self, prediction: Prediction, known: Flags, normal_stiffness_N_per_m: Numbers, torsional_stiffness_Nm_per_rad: Numbers, tangential_stiffness_x_N_per_m: Numbers, tangential_stiffness_y_N_per_m: Numbers, d_a_m: Derivatives, d_b_m: Derivatives, d_indentation_m: Derivatives, d_area_m2: Derivatives, d_peak_pressure_Pa: Derivatives, d_pressure_arm_m: Derivatives, d_torque_arm_exact_m: Derivatives, d_torque_arm_paper_m: Derivatives, d_max_torque_Nm: Derivatives, d_torsional_stiffness_Nm_per_rad: Derivatives, d_tangential_stiffness_x_N_per_m: Derivatives, d_tangential_stiffness_y_N_per_m: Derivatives) -> None: ...

class ProgramError(RuntimeError):
    ...

class QuadricFit:
    A_per_m: float
    B_per_m: float
    C_per_m: float
    covariance_per_m2: numpy.ndarray
    radii_m: numpy.ndarray
    axis_rad: float
    radii_std_m: numpy.ndarray
    radii_region_change_m: numpy.ndarray
    origin_m: numpy.ndarray
    normal: numpy.ndarray
    x_axis: numpy.ndarray
    residual_rms_m: float
    region_radius_m: float
    area_m2: float
    points: int
    outliers: int
    has_sharp_edge: bool
    sharpest_kink_rad: float
    def __init__(self, A_per_m: float, B_per_m: float, C_per_m: float, covariance_per_m2: numpy.ndarray, radii_m: numpy.ndarray, axis_rad: float, radii_std_m: numpy.ndarray, radii_region_change_m: numpy.ndarray, origin_m: numpy.ndarray, normal: numpy.ndarray, x_axis: numpy.ndarray, residual_rms_m: float, region_radius_m: float, area_m2: float, points: int, outliers: int, has_sharp_edge: bool, sharpest_kink_rad: float) -> None: ...

class Scene:
    def __init__(self, scene): ...
    def close(self) -> None: ...
    @property
    def time_s(self) -> float: ...
    @property
    def ended(self) -> bool: ...
    @property
    def bodies(self) -> tuple[str, ...]: ...
    @property
    def joints(self) -> tuple[str, ...]: ...
    def step(self, count: int = ...) -> None: ...
    def set_motor(self, joint: str, **fields: float) -> None: ...
    def apply_force(self, body: str, force_N=..., torque_Nm=..., point_in_body_m=...) -> None: ...
    def set_gravity(self, gravity_m_per_s2) -> None: ...
    def pose(self, body: str) -> numpy.ndarray: ...
    def velocity_m_per_s(self, body: str) -> numpy.ndarray: ...
    def angular_velocity_rad_per_s(self, body: str) -> numpy.ndarray: ...
    def joint_position(self, joint: str) -> float: ...
    def joint_velocity(self, joint: str) -> float: ...
    def motor_effort(self, joint: str) -> float: ...
    def contacts(self) -> tuple[SceneContact, ...]: ...

class SceneContact:
    bodies: tuple[str, str]
    point_m: numpy.ndarray
    normal: numpy.ndarray
    force_N: numpy.ndarray
    normal_force_N: float
    torque_Nm: float
    semi_axes_m: numpy.ndarray
    eccentricity_m: float
    utilisation: float
    slides: bool
    model: str
    friction_law: str
    def __init__(self, bodies: tuple[str, str], point_m: numpy.ndarray, normal: numpy.ndarray, force_N: numpy.ndarray, normal_force_N: float, torque_Nm: float, semi_axes_m: numpy.ndarray, eccentricity_m: float, utilisation: float, slides: bool, model: str, friction_law: str) -> None: ...

class ShearSurface:
    a_m: float
    b_m: float
    exponent: float
    load_N: float
    shear_law: str
    friction_coefficient: Optional[float]
    shear_strength_Pa: Optional[float]
    def __init__(self, a_m: float, b_m: float, exponent: float, load_N: float, shear_law: str, friction_coefficient: Optional[float] = ..., shear_strength_Pa: Optional[float] = ...) -> None: ...
    @property
    def eccentricity_m(self) -> float: ...
    @property
    def max_torque_Nm(self) -> Numbers: ...
    def ellipsoid(self) -> FrictionEllipsoid: ...
    def wrench_for_twist(self, twist: ArrayLike) -> numpy.ndarray: ...
    def support(self, twist: ArrayLike) -> Numbers: ...
    def utilisation(self, wrench: ArrayLike) -> Numbers: ...
    def contains(self, wrench: ArrayLike) -> Flags: ...
    def project(self, wrench: ArrayLike) -> numpy.ndarray: ...
    def sample(self, count: int) -> numpy.ndarray: ...
    def sample_section(self, direction_rad: float, count: int) -> numpy.ndarray: ...
    @property
    def max_force_N(self) -> float: ...

class Simulation:
    def __init__(self, bodies: Sequence[Body], contacts: Union[Sequence, Callable[[Simulation], Sequence[Contact]]] = ..., joints: Sequence[Joint] = ..., motors: Sequence[Motor] = ..., *, time_step_s: float = ..., gravity_m_per_s2: ArrayLike = ..., friction: str = ...) -> None: ...
    @property
    def time_s(self) -> float: ...
    @property
    def energy_J(self) -> float: ...
    def step(self, count: int = ...) -> None: ...
    def pose(self, body: str) -> numpy.ndarray: ...
    def velocity_m_per_s(self, body: str) -> numpy.ndarray: ...
    def angular_velocity_rad_per_s(self, body: str) -> numpy.ndarray: ...
    def joint_position(self, joint: str) -> float: ...
    def joint_velocity(self, joint: str) -> float: ...
    def motor(self, joint: str) -> Motor: ...
    def set_motor(self, joint: str, **changes: float) -> None: ...
    def motor_effort(self, joint: str) -> float: ...
    def set_gravity(self, gravity_m_per_s2: ArrayLike) -> None: ...
    def apply_force(self, body: str, force_N: ArrayLike = ..., torque_Nm: ArrayLike = ..., point_in_body_m: ArrayLike = ...) -> None: ...
    def contacts(self) -> list[ContactState]: ...

class SphereOnPlane:
    a: str
    b: str
    friction_coefficient: float
    eccentricity_m: Union[float, Callable[[float], float]]
    shape: Optional[tuple[float, float]]
    radius_m: float
    def __init__(self, a: str, b: str, radius_m: float, *, friction_coefficient: float, eccentricity_m: Union[float, Callable[[float], float]] = ..., shape: Optional[tuple[float, float]] = ...) -> None: ...
    def find(self, simulation: Simulation) -> Iterable[Contact]: ...

class SphereOnSphere:
    a: str
    b: str
    friction_coefficient: float
    eccentricity_m: Union[float, Callable[[float], float]]
    shape: Optional[tuple[float, float]]
    radius_a_m: float
    radius_b_m: float
    def __init__(self, a: str, b: str, radius_a_m: float, radius_b_m: float, *, friction_coefficient: float, eccentricity_m: Union[float, Callable[[float], float]] = ..., shape: Optional[tuple[float, float]] = ...) -> None: ...
    def find(self, simulation: Simulation) -> Iterable[Contact]: ...

class StepError(RuntimeError):
    ...

class TaxelReadings:
    model: str
    x_m: numpy.ndarray
    y_m: numpy.ndarray
    pitch_m: float
    depth_m: float
    force_N: numpy.ndarray
    pressure_Pa: numpy.ndarray
    shear_x_Pa: numpy.ndarray
    shear_y_Pa: numpy.ndarray
    displacement_m: numpy.ndarray
    load_N: float
    outside_N: float
    shown_a_m: float
    shown_b_m: float
    shown_torque_arm_m: float
    def __init__(self, model: str, x_m: numpy.ndarray, y_m: numpy.ndarray, pitch_m: float, depth_m: float, force_N: numpy.ndarray, pressure_Pa: numpy.ndarray, shear_x_Pa: numpy.ndarray, shear_y_Pa: numpy.ndarray, displacement_m: numpy.ndarray, load_N: float, outside_N: float, shown_a_m: float, shown_b_m: float, shown_torque_arm_m: float) -> None: ...
    def arrays(self) -> dict[str, numpy.ndarray]: ...

def calibrate(*, load_N: ArrayLike, radius_major_m: float, radius_minor_m: float, youngs_modulus_Pa: float, thickness_m: float, poisson_ratio: float, a_m: Optional[ArrayLike] = ..., a_m_std: Optional[ArrayLike] = ..., b_m: Optional[ArrayLike] = ..., b_m_std: Optional[ArrayLike] = ..., area_m2: Optional[ArrayLike] = ..., area_m2_std: Optional[ArrayLike] = ..., indentation_m: Optional[ArrayLike] = ..., indentation_m_std: Optional[ArrayLike] = ..., max_torque_Nm: Optional[ArrayLike] = ..., max_torque_Nm_std: Optional[ArrayLike] = ..., tangential_force_N: Optional[ArrayLike] = ..., tangential_force_N_std: Optional[ArrayLike] = ..., friction_coefficient: Optional[float] = ..., shear_strength_Pa: Optional[float] = ..., shear_law: str = ..., pressing: Optional[str] = ..., finger_xx_per_m: float = ..., finger_yy_per_m: float = ..., finger_xy_per_m: float = ..., winkler_modulus: str = ..., fit: Union[None, str, Sequence[str]] = ..., fixed: Optional[Mapping[str, float]] = ..., model: Optional[str] = ...) -> Calibration: ...

def checks(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., model: Optional[str] = ...) -> tuple[Check, ...]: ...

def eccentricity_law(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., model: Optional[str] = ...) -> Callable[[float], float]: ...

def error_bound(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., model: Optional[str] = ...) -> ErrorBound: ...

def fem(case: Union[None, str, os.PathLike, dict] = ..., *, level: Optional[int] = ..., torsion: bool = ..., limit_surface: Optional[int] = ..., approach_m: Optional[float] = ..., output: Union[None, str, os.PathLike] = ..., time_limit_s: Optional[float] = ..., **contact: ArrayLike) -> tuple[FemResult, ...]: ...

def fit(surface: Union[ArrayLike, tuple[ArrayLike, ArrayLike]], point_m: ArrayLike, region_radius_m: float, outward_normal: Optional[ArrayLike] = ...) -> QuadricFit: ...

def gap_between(finger: Curvature, object: Curvature = ..., angle_rad: ArrayLike = ...) -> Gap: ...

def models() -> dict[str, ModelCard]: ...

def predict(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: Optional[ArrayLike] = ..., finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., shear_strength_Pa: Optional[ArrayLike] = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., shear_law: str = ..., model: Optional[str] = ...) -> Prediction: ...

def predict_with_gradient(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., model: Optional[str] = ...) -> PredictionWithGradient: ...

def pressure_Pa(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., x_m: ArrayLike, y_m: ArrayLike, model: Optional[str] = ...) -> Numbers: ...

def select(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., tolerance: float = ..., models: Optional[Sequence[str]] = ..., quantities: Sequence[str] = ...) -> Choice: ...

def simulate(scene: Union[str, os.PathLike, dict]) -> Scene: ...

def taxels(*, normal_force_N: ArrayLike, youngs_modulus_Pa: ArrayLike, poisson_ratio: ArrayLike, thickness_m: ArrayLike, radius_major_m: ArrayLike, radius_minor_m: ArrayLike, friction_coefficient: ArrayLike, finger_xx_per_m: ArrayLike = ..., finger_yy_per_m: ArrayLike = ..., finger_xy_per_m: ArrayLike = ..., object_thickness_m: ArrayLike = ..., object_youngs_modulus_Pa: ArrayLike = ..., object_poisson_ratio: ArrayLike = ..., pressing: Optional[str] = ..., is_object_spherical: bool = ..., winkler_modulus: str = ..., power_law_coefficient: float = ..., power_law_exponent: float = ..., power_law_pressure_exponent: float = ..., columns: int, rows: int, pitch_m: Optional[float] = ..., depth_m: float = ..., model: Optional[str] = ...) -> TaxelReadings: ...

def weld(corners_m: ArrayLike) -> tuple[numpy.ndarray, numpy.ndarray]: ...
