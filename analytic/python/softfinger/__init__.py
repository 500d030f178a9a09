"""Reference models for soft-finger contact, in about a microsecond: contact ellipse, pressure,
largest frictional torque and limit surface of an elastic layer on a rigid core. SI units
throughout; each name ends with its unit. Arrays broadcast.

    import softfinger
    contact = softfinger.predict(normal_force_N=2.0, youngs_modulus_Pa=300e3, poisson_ratio=0.45,
                                 thickness_m=2e-3, radius_major_m=20e-3, radius_minor_m=5e-3,
                                 friction_coefficient=0.8)
    contact.max_torque_Nm
"""

from ._accuracy import Choice, ErrorBound, Errors, error_bound, select
from ._calibrate import (
    Calibration,
    Curve,
    Estimate,
    Goodness,
    ModelFit,
    NextMeasurement,
    Outlier,
    calibrate,
)
from ._core import __version__
from ._errors import InputError, NoAnswer, ProgramError
from ._fem import FemResult, fem
from ._friction import FrictionEllipsoid, LimitSurface, ShearSurface
from ._geometry import Gap, QuadricFit, fit, gap_between, weld
from ._gradient import Derivatives, PredictionWithGradient, predict_with_gradient
from ._pads import FlatPad, PadPrediction
from ._predict import Check, ModelCard, Prediction, checks, models, predict, pressure_Pa
from ._scene import Scene, SceneContact, simulate
from ._simulation import (
    BoxOnPlane,
    Body,
    Contact,
    ContactState,
    Joint,
    Motor,
    Simulation,
    SphereOnPlane,
    SphereOnSphere,
    StepError,
    eccentricity_law,
)
from ._taxels import TaxelReadings, taxels

__all__ = [
    "Body",
    "BoxOnPlane",
    "Calibration",
    "Check",
    "Choice",
    "Contact",
    "ContactState",
    "Curve",
    "Derivatives",
    "ErrorBound",
    "Errors",
    "Estimate",
    "FemResult",
    "FlatPad",
    "FrictionEllipsoid",
    "Gap",
    "Goodness",
    "InputError",
    "Joint",
    "LimitSurface",
    "ModelCard",
    "ModelFit",
    "Motor",
    "NextMeasurement",
    "NoAnswer",
    "Outlier",
    "PadPrediction",
    "Prediction",
    "PredictionWithGradient",
    "ProgramError",
    "QuadricFit",
    "Scene",
    "SceneContact",
    "ShearSurface",
    "Simulation",
    "SphereOnPlane",
    "SphereOnSphere",
    "StepError",
    "TaxelReadings",
    "calibrate",
    "checks",
    "eccentricity_law",
    "error_bound",
    "fem",
    "fit",
    "gap_between",
    "models",
    "predict",
    "predict_with_gradient",
    "pressure_Pa",
    "select",
    "simulate",
    "taxels",
    "weld",
]


def __getattr__(name):  # only for what is not there
    from ._names import unknown_attribute

    raise unknown_attribute("softfinger", name, __all__)
