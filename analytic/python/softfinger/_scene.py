"""Scenes in motion under Python's control, by the program `softfinger` where it is installed."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from typing import Union

import numpy

from ._errors import InputError
from ._names import choices
from ._program import find_program, input_file, refusal
from ._result import Result, result
from ._simulation import StepError


@result
class SceneContact(Result):
    """A contact at the end of a step. The force acts on the second body."""

    bodies: tuple[str, str]
    point_m: numpy.ndarray
    normal: numpy.ndarray  #: from the first body to the second
    force_N: numpy.ndarray  #: (3,), along the world's axes
    normal_force_N: float
    torque_Nm: float  #: about the normal
    semi_axes_m: numpy.ndarray  #: of the contact ellipse; zero for a point
    eccentricity_m: float  #: e_n at this load; 0: carries no torque
    utilisation: float  #: of the friction limit, 1 at the limit
    slides: bool
    model: str  #: pressure model, or "rigid", "given"
    friction_law: str


class Scene:
    """A scene at some time: read its state, set targets, step. Made by `simulate`.

    Ends with its `with` block, or when `close` is called.
    """

    def __init__(self, scene):
        program = find_program()
        self._folder = tempfile.TemporaryDirectory()
        self._told = tempfile.TemporaryFile("w+")
        self._process = subprocess.Popen(
            [program, "simulate", input_file(scene, self._folder.name), "--control"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._told,
            text=True,
        )
        self._changes = {}
        self._read()

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Ends the program. The last state can still be read."""
        if self._process.stdin:
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()
        self._told.close()
        self._folder.cleanup()

    def _read(self):
        line = self._process.stdout.readline()
        if line:
            state = json.loads(line)
            self._state = state
            self._bodies = {body["name"]: body for body in state["bodies"]}
            self._joints = {joint["name"]: joint for joint in state["joints"]}
            return
        status = self._process.wait()
        self._told.seek(0)
        error = refusal(status, self._told.read())
        self.close()
        no_solution = 3  # the program's status for a step that failed
        raise StepError(str(error)) if status == no_solution else error

    @property
    def time_s(self) -> float:
        return self._state["time_s"]

    @property
    def ended(self) -> bool:
        """Whether the scene's duration is over."""
        return self._state["ended"]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self._bodies)

    @property
    def joints(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self._joints)

    def step(self, count: int = 1) -> None:
        """Moves on by `count` time steps of the scene, at most to its end.

        Raises:
            InputError: the scene has ended, or what was set since the last step cannot be used
            StepError: a step has no solution
        """
        if self.ended:
            raise InputError(
                "step", "time_s", self.time_s, "before the scene's end (its duration_s)"
            )
        if self._process.poll() is None:
            command = json.dumps({"steps": count, **self._changes})
            try:
                self._process.stdin.write(command + "\n")
                self._process.stdin.flush()
            except BrokenPipeError:
                pass  # it says why
        self._changes = {}
        self._read()

    def set_motor(self, joint: str, **fields: float) -> None:
        """Sets fields of a joint's Motor from the next step on, also against the scene's own tables:
        set_motor("lift", target=0.02)."""
        values = {name: None if numpy.isposinf(x) else float(x) for name, x in fields.items()}
        self._changes.setdefault("motors", {}).setdefault(joint, {}).update(values)

    def apply_force(
        self, body: str, force_N=(0, 0, 0), torque_Nm=(0, 0, 0), point_in_body_m=(0, 0, 0)
    ) -> None:
        """Pulls at a body from outside, world axes, until it is set anew."""
        vectors = dict(force_N=force_N, torque_Nm=torque_Nm, point_in_body_m=point_in_body_m)
        self._changes.setdefault("forces", {})[body] = {
            name: [float(x) for x in vector] for name, vector in vectors.items()
        }

    def set_gravity(self, gravity_m_per_s2) -> None:
        self._changes["gravity_m_per_s2"] = [float(x) for x in gravity_m_per_s2]

    def pose(self, body: str) -> numpy.ndarray:
        """(4, 4), of the body's frame in the world."""
        state = self._of("pose", "body", self._bodies, body)
        w, x, y, z = state["quaternion_wxyz"]
        pose = numpy.eye(4)
        pose[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        pose[:3, 3] = state["position_m"]
        return pose

    def velocity_m_per_s(self, body: str) -> numpy.ndarray:
        """(3,), of the body's centre of mass, world axes."""
        state = self._of("velocity_m_per_s", "body", self._bodies, body)
        return numpy.array(state["velocity_m_per_s"])

    def angular_velocity_rad_per_s(self, body: str) -> numpy.ndarray:
        """(3,), world axes."""
        state = self._of("angular_velocity_rad_per_s", "body", self._bodies, body)
        return numpy.array(state["angular_velocity_rad_per_s"])

    def joint_position(self, joint: str) -> float:
        """In rad or m."""
        return self._of("joint_position", "joint", self._joints, joint)["position"]

    def joint_velocity(self, joint: str) -> float:
        """In rad/s or m/s."""
        return self._of("joint_velocity", "joint", self._joints, joint)["velocity"]

    def motor_effort(self, joint: str) -> float:
        """Of the last step, in N m or N; 0 for a joint without motor."""
        return self._of("motor_effort", "joint", self._joints, joint)["effort"]

    def contacts(self) -> tuple[SceneContact, ...]:
        """The loaded contacts of the last step."""
        arrays = ("point_m", "normal", "force_N", "semi_axes_m")
        return tuple(
            SceneContact(
                **{
                    name: numpy.array(x) if name in arrays else tuple(x) if name == "bodies" else x
                    for name, x in contact.items()
                }
            )
            for contact in self._state["contacts"]
        )

    @staticmethod
    def _of(function, argument, states, name):
        if name not in states:
            raise InputError(function, argument, name, choices(name, states) or "there is none")
        return states[name]


def simulate(scene: Union[str, os.PathLike, dict]) -> Scene:
    """Starts a scene: bodies of any shape with soft and rigid contacts, joints, motors.

        with softfinger.simulate("lift_box") as scene:
            while not scene.ended:
                scene.set_motor("lift", target=0.01)
                scene.step(10)

    The program `softfinger simulate --control` does the steps, in a process of its own. The scene's own
    motions hold until something else is set. `Simulation` does without the program, with contacts
    of balls and boxes, or such as you find yourself.

    Args:
        scene: name of a built-in scene, path of a scene file (TOML), or a dict with the tables of one

    Returns:
        Scene, at its start

    Raises:
        InputError: the scene cannot be used
        ProgramError: the program is missing (the message says how to get it)
    """
    return Scene(scene)
