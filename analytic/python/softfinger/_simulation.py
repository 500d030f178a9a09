"""Rigid bodies with soft contacts in motion, step by step.

Each step solves one complementarity problem for all contacts and joint limits; friction and its
torque limit e_n(P) belong to the loads of the same step (Ciocarlie, Lackner, Allen 2007, eq. 2-6;
Anitescu, Potra 1997). Scene files, with collision detection between any shapes, are run by the
program, `softfinger simulate`; here contacts come from closed forms (SphereOnPlane,
SphereOnSphere, BoxOnPlane) or from a function of your own.
"""

from __future__ import annotations

import dataclasses
from typing import Callable, Iterable, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._contacts import (
    FINITE,
    NOT_NEGATIVE,
    POSITIVE,
    Range,
    as_numbers,
    check_model,
    check_range,
    takes_contacts,
)
from ._errors import InputError
from ._names import choices
from ._predict import predict
from ._result import Result, result

_FRICTION = ("ellipsoid", "six_patches", "limit_surface")
_KINDS = ("fixed", "revolute", "prismatic", "ball")
_LIMIT = Range(lambda x: ~numpy.isnan(x), "a number, infinite ones included")


def _array(function, name, value, shape):
    array = as_numbers(function, name, value)
    if array.shape != shape:
        raise InputError(function, name, f"array of shape {array.shape}", f"shape {shape}")
    check_range(function, name, array, FINITE)
    return array


def _number(function, name, value, allowed=FINITE):
    number = as_numbers(function, name, value)
    if number.shape:
        raise InputError(function, name, f"array of shape {number.shape}", "one number")
    check_range(function, name, number, allowed)
    return float(number)


def _checked(owner, shapes, ranges=()):
    """Arrays of these shapes and numbers in these ranges, in place."""
    function = type(owner).__name__
    for name, shape in shapes.items():
        object.__setattr__(owner, name, _array(function, name, getattr(owner, name), shape))
    for name, allowed in dict(ranges).items():
        object.__setattr__(owner, name, _number(function, name, getattr(owner, name), allowed))


def _zeros():
    return dataclasses.field(default_factory=lambda: numpy.zeros(3))


@result
class Body(Result):
    """A rigid body at the start. Mass and inertia of a fixed one do not matter."""

    name: str
    mass_kg: float = 1.0
    inertia_kg_m2: ArrayLike = dataclasses.field(
        default_factory=lambda: numpy.eye(3)
    )  #: about center_m
    center_m: ArrayLike = _zeros()  #: of mass, in the body's frame
    fixed: bool = False
    pose: ArrayLike = dataclasses.field(
        default_factory=lambda: numpy.eye(4)
    )  #: of its frame in the world
    velocity_m_per_s: ArrayLike = _zeros()  #: of a free body's centre of mass
    angular_velocity_rad_per_s: ArrayLike = _zeros()

    def __post_init__(self):
        _checked(
            self,
            {
                "inertia_kg_m2": (3, 3),
                "center_m": (3,),
                "pose": (4, 4),
                "velocity_m_per_s": (3,),
                "angular_velocity_rad_per_s": (3,),
            },
            {"mass_kg": POSITIVE},
        )
        turn = self.pose[:3, :3]
        if not (
            numpy.allclose(turn @ turn.T, numpy.eye(3), atol=1e-9)
            and numpy.linalg.det(turn) > 0
            and (self.pose[3] == (0, 0, 0, 1)).all()
        ):
            raise InputError("Body", "pose", self.pose.tolist(), "a rotation and a translation")

    @classmethod
    def sphere(
        cls, name: str, radius_m: float, mass_kg: float, position_m: ArrayLike, **others
    ) -> Body:
        """A homogeneous ball about its frame's origin."""
        radius = _number("Body.sphere", "radius_m", radius_m, POSITIVE)
        return cls(
            name,
            mass_kg,
            0.4 * mass_kg * radius**2 * numpy.eye(3),
            pose=_at(position_m),
            **others,
        )

    @classmethod
    def box(
        cls, name: str, size_m: ArrayLike, mass_kg: float, position_m: ArrayLike, **others
    ) -> Body:
        """A homogeneous box about its frame's origin, with edges along its axes."""
        square = _array("Body.box", "size_m", size_m, (3,)) ** 2
        return cls(
            name,
            mass_kg,
            mass_kg / 12 * numpy.diag(square.sum() - square),
            pose=_at(position_m),
            **others,
        )

    @classmethod
    def ground(cls, name: str = "ground") -> Body:
        """A fixed body at the origin."""
        return cls(name, fixed=True)


def _at(position_m):
    pose = numpy.eye(4)
    pose[:3, 3] = _array("Body", "position_m", position_m, (3,))
    return pose


@result
class Joint(Result):
    """How `child` hangs on `parent` (names of bodies; None: the world). Anchor and axis in world
    coordinates at the start, where the joint's position is `start`, in rad or m."""

    name: str
    child: str
    kind: str  #: "fixed", "revolute", "prismatic" or "ball"
    parent: Optional[str] = None
    axis: ArrayLike = (0.0, 0.0, 1.0)
    anchor_m: ArrayLike = (0.0, 0.0, 0.0)
    start: float = 0.0
    lower: float = -numpy.inf
    upper: float = numpy.inf

    def __post_init__(self):
        if self.kind not in _KINDS:
            raise InputError("Joint", "kind", self.kind, choices(self.kind, _KINDS))
        _checked(
            self,
            {"axis": (3,), "anchor_m": (3,)},
            {"start": FINITE, "lower": _LIMIT, "upper": _LIMIT},
        )


@result
class Motor(Result):
    """Drives a joint: effort = stiffness (target - position) + damping (target_velocity - velocity)
    + feed_forward, within +-max_effort. Stiffness and damping act implicitly: none makes a step
    unstable. N m or N, rad or m."""

    joint: str
    stiffness: float = 0.0
    damping: float = 0.0
    feed_forward: float = 0.0
    max_effort: float = numpy.inf
    target: float = 0.0
    target_velocity: float = 0.0

    def __post_init__(self):
        limit = Range(lambda x: x >= 0, "not negative")
        _checked(
            self,
            {},
            {
                "stiffness": NOT_NEGATIVE,
                "damping": NOT_NEGATIVE,
                "feed_forward": FINITE,
                "max_effort": limit,
                "target": FINITE,
                "target_velocity": FINITE,
            },
        )


@takes_contacts
def eccentricity_law(contacts, model: Optional[str] = None) -> Callable[[float], float]:
    """e_n of a soft contact as its load changes, for the contacts of a simulation.

    The load given is replaced by that of each step; the friction coefficient is the contact's own.

    Args:
        model: a name out of `models()`; default: the recommended one

    Returns:
        a function: law(load_N) is e_n in m

    Raises:
        NoAnswer: the model has none at the load given
    """
    check_model("eccentricity_law", model)
    contacts.require_single("eccentricity_law", "call it for each")
    asked = predict.of_contacts(contacts, model)
    return _core.ModelEccentricity(asked.model, contacts.numbers)


@dataclasses.dataclass(frozen=True)
class Contact:
    """Where two bodies touch, or are about to, as a function of your own finds it."""

    a: str  #: names of the bodies
    b: str
    point_m: ArrayLike  #: (3,), halfway between the surfaces
    normal: ArrayLike  #: (3,), unit, from a to b
    gap_m: float  #: negative: the bodies overlap
    friction_coefficient: float
    eccentricity_m: Union[
        float, Callable[[float], float]
    ] = 0.0  #: e_n in m, or an eccentricity_law; 0: a point without torque
    id: int = 0  #: the same from step to step for as long as the contact lasts
    long_axis: Optional[
        ArrayLike
    ] = None  #: (3,), unit, along the contact ellipse; default: any across the normal
    shape: Optional[
        tuple[float, float]
    ] = None  #: (b/a, exponent n), for "six_patches" and "limit_surface"; None: ellipsoid


@dataclasses.dataclass(frozen=True)
class _Pair:
    """Bodies, and what their contact is like."""

    a: str
    b: str
    friction_coefficient: float = dataclasses.field(kw_only=True)
    eccentricity_m: Union[float, Callable[[float], float]] = dataclasses.field(
        default=0.0, kw_only=True
    )  #: see Contact
    shape: Optional[tuple[float, float]] = dataclasses.field(default=None, kw_only=True)

    def _contact(self, point_m, normal, gap_m, number):
        return Contact(
            self.a,
            self.b,
            point_m,
            normal,
            gap_m,
            self.friction_coefficient,
            self.eccentricity_m,
            number,
            None,
            self.shape,
        )


@dataclasses.dataclass(frozen=True)
class SphereOnPlane(_Pair):
    """The ball b about its frame's origin on the plane z = 0 of a's frame, whose normal is z."""

    radius_m: float

    def find(self, simulation: Simulation) -> Iterable[Contact]:
        plane, ball = simulation.pose(self.a), simulation.pose(self.b)
        normal = plane[:3, 2]
        gap = normal @ (ball[:3, 3] - plane[:3, 3]) - self.radius_m
        yield self._contact(ball[:3, 3] - (self.radius_m + gap / 2) * normal, normal, gap, 0)


@dataclasses.dataclass(frozen=True)
class SphereOnSphere(_Pair):
    """Two balls about their frames' origins."""

    radius_a_m: float
    radius_b_m: float

    def find(self, simulation: Simulation) -> Iterable[Contact]:
        center, other = simulation.pose(self.a)[:3, 3], simulation.pose(self.b)[:3, 3]
        distance = numpy.linalg.norm(other - center)
        normal = (other - center) / distance
        gap = distance - self.radius_a_m - self.radius_b_m
        yield self._contact(center + (self.radius_a_m + gap / 2) * normal, normal, gap, 0)


@dataclasses.dataclass(frozen=True)
class BoxOnPlane(_Pair):
    """The corners of the box b about its frame's origin on the plane z = 0 of a's frame."""

    size_m: ArrayLike

    def find(self, simulation: Simulation) -> Iterable[Contact]:
        plane, box = simulation.pose(self.a), simulation.pose(self.b)
        normal = plane[:3, 2]
        for number in range(8):
            side = numpy.array([1 if number & bit else -1 for bit in (1, 2, 4)])
            corner = box[:3, :3] @ (side * numpy.asarray(self.size_m) / 2)
            if normal @ corner < 0:
                on_box = corner + box[:3, 3]
                gap = normal @ (on_box - plane[:3, 3])
                yield self._contact(on_box - gap / 2 * normal, normal, gap, number)


@result
class ContactState(Result):
    """A contact of the last step: the mean force and torque that it exerts on body b."""

    a: str
    b: str
    id: int
    point_m: numpy.ndarray
    axes: numpy.ndarray  #: columns: along the long axis, the short axis, the normal from a to b
    gap_m: float  #: at the start of the step
    friction_coefficient: float
    normal_force_N: float
    tangent_force_1_N: float
    tangent_force_2_N: float
    torque_Nm: float
    eccentricity_m: float  #: e_n at this load
    slip_m_per_s: float  #: of a sliding contact: sqrt(v² + e_n² omega²) with the ellipsoid


class StepError(RuntimeError):
    """A step has no solution, for instance because bodies are driven into each other. Nothing has
    moved: the simulation is where it was before."""


class Simulation:
    """Bodies, joints, motors and contacts, moved step by step.

    Args:
        bodies: list of Body, with names of their own
        joints, motors: lists of Joint and Motor
        contacts: list of SphereOnPlane, SphereOnSphere, BoxOnPlane; or a function of the simulation
            that returns a list of Contact, called once per step
        time_step_s: positive
        gravity_m_per_s2: (3,)
        friction: "ellipsoid"; or "six_patches", "limit_surface" for contacts with a shape

    Raises:
        InputError: an argument cannot be used

    All methods take bodies and joints by their names, and motors by their joints'. Contacts that
    are found in Python take most of a small scene's time. Other threads run during a step.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        contacts: Union[Sequence, Callable[[Simulation], Sequence[Contact]]] = (),
        joints: Sequence[Joint] = (),
        motors: Sequence[Motor] = (),
        *,
        time_step_s: float = 1e-3,
        gravity_m_per_s2: ArrayLike = (0.0, 0.0, -9.81),
        friction: str = "ellipsoid",
    ) -> None:
        if friction not in _FRICTION:
            raise InputError("Simulation", "friction", friction, choices(friction, _FRICTION))
        self._body = _index("bodies", [body.name for body in bodies])
        self._joint = _index("joints", [joint.name for joint in joints])
        self._motors = {motor.joint: motor for motor in motors}
        self._motor = _index("motors", [motor.joint for motor in motors])
        self._find = contacts if callable(contacts) else _of_pairs(contacts)
        self._is_stepping = False
        numbered_joints = [
            dataclasses.replace(
                joint,
                child=self._index_of("Joint", "child", self._body, joint.child),
                parent=-1
                if joint.parent is None
                else self._index_of("Joint", "parent", self._body, joint.parent),
            )
            for joint in joints
        ]
        numbered_motors = [
            dataclasses.replace(
                motor, joint=self._index_of("Motor", "joint", self._joint, motor.joint)
            )
            for motor in motors
        ]
        self._core = _core.Stepper(
            list(bodies),
            numbered_joints,
            numbered_motors,
            self._contacts_now,
            {
                "time_step_s": _number("Simulation", "time_step_s", time_step_s, POSITIVE),
                "gravity_m_per_s2": _array(
                    "Simulation", "gravity_m_per_s2", gravity_m_per_s2, (3,)
                ),
                "friction": friction,
            },
        )

    @property
    def time_s(self) -> float:
        return self._core.time_s

    @property
    def energy_J(self) -> float:
        """Kinetic and potential energy of all bodies."""
        return self._core.energy_J

    def step(self, count: int = 1) -> None:
        """Moves on by `count` time steps.

        Raises:
            StepError: a step has no solution; the steps before it are done
        """
        if self._is_stepping:
            raise InputError(
                "Simulation.step", "contacts", "a call of step", "reading the state only"
            )
        for _ in range(count):
            self._is_stepping = True
            try:
                step = self._core.step()
            finally:
                self._is_stepping = False
            if not step["done"]:
                why = (
                    "no impulses keep the bodies apart"
                    if step["is_infeasible"]
                    else "the contact problem was not solved"
                )
                raise StepError(
                    f"the step after {self.time_s:.6g} s has no solution: {why} "
                    f"(contacts {step['contacts']}, residual {step['residual']:.2g})"
                )

    def pose(self, body: str) -> numpy.ndarray:
        """(4, 4), of the body's frame in the world."""
        return self._core.pose(self._index_of("pose", "body", self._body, body))

    def velocity_m_per_s(self, body: str) -> numpy.ndarray:
        """(3,), of the body's centre of mass, world axes."""
        return self._core.velocity_m_per_s(
            self._index_of("velocity_m_per_s", "body", self._body, body)
        )

    def angular_velocity_rad_per_s(self, body: str) -> numpy.ndarray:
        """(3,), world axes."""
        return self._core.angular_velocity_rad_per_s(
            self._index_of("angular_velocity_rad_per_s", "body", self._body, body)
        )

    def joint_position(self, joint: str) -> float:
        """In rad or m."""
        return self._core.joint_position(
            self._index_of("joint_position", "joint", self._joint, joint)
        )

    def joint_velocity(self, joint: str) -> float:
        """In rad/s or m/s."""
        return self._core.joint_velocity(
            self._index_of("joint_velocity", "joint", self._joint, joint)
        )

    def motor(self, joint: str) -> Motor:
        """The Motor of a joint, as it is driven now."""
        self._index_of("motor", "joint", self._motor, joint)
        return self._motors[joint]

    def set_motor(self, joint: str, **changes: float) -> None:
        """Changes fields of a joint's Motor: set_motor("lift", target=0.02)."""
        index = self._index_of("set_motor", "joint", self._motor, joint)
        if "joint" in changes:
            raise InputError("set_motor", "joint", changes["joint"], "fields other than joint")
        self._motors[joint] = dataclasses.replace(self._motors[joint], **changes)
        self._core.drive_motor(index, self._motors[joint])

    def motor_effort(self, joint: str) -> float:
        """Of the last step, in N m or N."""
        return self._core.motor_effort(self._index_of("motor_effort", "joint", self._motor, joint))

    def set_gravity(self, gravity_m_per_s2: ArrayLike) -> None:
        self._core.set_gravity(_array("set_gravity", "gravity_m_per_s2", gravity_m_per_s2, (3,)))

    def apply_force(
        self,
        body: str,
        force_N: ArrayLike = (0, 0, 0),
        torque_Nm: ArrayLike = (0, 0, 0),
        point_in_body_m: ArrayLike = (0, 0, 0),
    ) -> None:
        """Pulls at a body from outside, world axes, until it is set anew."""
        self._core.apply(
            self._index_of("apply_force", "body", self._body, body),
            _array("apply_force", "point_in_body_m", point_in_body_m, (3,)),
            _array("apply_force", "force_N", force_N, (3,)),
            _array("apply_force", "torque_Nm", torque_Nm, (3,)),
        )

    def contacts(self) -> list[ContactState]:
        """The contacts of the last step, a list of ContactState."""
        names = list(self._body)
        return [
            ContactState(**{**state, "a": names[state["a"]], "b": names[state["b"]]})
            for state in self._core.contacts()
        ]

    def _contacts_now(self, _time_step_s):
        return [self._numbered(contact) for contact in self._find(self)]

    def _numbered(self, contact):
        """A contact with bodies as indices and with axes, checked."""
        a = self._index_of("Contact", "a", self._body, contact.a)
        b = self._index_of("Contact", "b", self._body, contact.b)
        if a == b:
            raise InputError("Contact", "b", contact.b, "another body than a")
        normal = _unit("normal", contact.normal)
        if contact.long_axis is None:
            across = numpy.eye(3)[numpy.argmin(numpy.abs(normal))]
            long_axis = across - normal * (normal @ across)
            long_axis /= numpy.linalg.norm(long_axis)
        else:
            long_axis = _unit("long_axis", contact.long_axis)
            if abs(long_axis @ normal) > 1e-9:
                raise InputError("Contact", "long_axis", long_axis.tolist(), "across the normal")
        eccentricity = contact.eccentricity_m
        if not isinstance(eccentricity, _core.ModelEccentricity):
            eccentricity = _number("Contact", "eccentricity_m", eccentricity, NOT_NEGATIVE)
        shape = contact.shape
        if shape is not None:
            aspect, exponent = shape
            shape = (
                _number(
                    "Contact",
                    "shape[0]",
                    aspect,
                    Range(lambda r: (r > 0) & (r <= 1), "above 0, at most 1"),
                ),
                _number(
                    "Contact",
                    "shape[1]",
                    exponent,
                    Range(lambda n: (n > -1) & (n <= 1000), "above -1, at most 1000"),
                ),
            )
        return _NumberedContact(
            a,
            b,
            _array("Contact", "point_m", contact.point_m, (3,)),
            numpy.column_stack([long_axis, numpy.cross(normal, long_axis), normal]),
            _number("Contact", "gap_m", contact.gap_m),
            _number("Contact", "friction_coefficient", contact.friction_coefficient, NOT_NEGATIVE),
            eccentricity,
            int(contact.id),
            shape,
        )

    @staticmethod
    def _index_of(function, argument, index, name):
        if name not in index:
            raise InputError(function, argument, name, choices(name, index) or "there is none")
        return index[name]


@dataclasses.dataclass(frozen=True)
class _NumberedContact:
    a: int
    b: int
    point_m: numpy.ndarray
    axes: numpy.ndarray
    gap_m: float
    friction_coefficient: float
    eccentricity_m: object
    id: int
    shape: object


def _unit(name, value):
    vector = _array("Contact", name, value, (3,))
    if abs(numpy.linalg.norm(vector) - 1) > 1e-9:
        raise InputError("Contact", name, vector.tolist(), "a unit vector")
    return vector


def _index(what, names):
    index = {name: i for i, name in enumerate(names)}
    if len(index) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError("Simulation", what, twice, "each name once")
    return index


def _of_pairs(pairs):
    """Finds the contacts of given pairs; their ids are unlike those of other pairs."""
    pairs = list(pairs)
    corners = 8

    def find(simulation):
        return [
            dataclasses.replace(contact, id=corners * p + contact.id)
            for p, pair in enumerate(pairs)
            for contact in pair.find(simulation)
        ]

    return find
