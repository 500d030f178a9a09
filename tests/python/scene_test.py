"""Scenes of the program under Python's control."""

import os
import unittest
from unittest import mock

import numpy

import softfinger
from samples import needs_program
from softfinger import _program

BALL = {
    "simulation": {"time_step_ms": 1, "duration_s": 0.2},
    "layer": [{"name": "foam", "thickness_mm": 2, "youngs_modulus_kPa": 100, "poisson_ratio": 0.3}],
    "body": [
        {"name": "table", "fixed": True, "shapes": [{"half_space": True}]},
        {
            "name": "ball",
            "position_mm": [0, 0, 10],
            "mass_g": 50,
            "angular_velocity_deg_per_s": [0, 0, 1440],
            "shapes": [{"sphere_radius_mm": 10}],
            "layer": "foam",
        },
    ],
    "contact": [{"bodies": ["ball", "*"], "friction_coefficient": 0.5}],
}


@needs_program
class Scenes(unittest.TestCase):
    def test_one_that_is_only_watched_is_that_of_the_program(self):
        told = _program.run_program(["simulate", "lift_box", "--json"])
        with softfinger.simulate("lift_box") as scene:
            while not scene.ended:
                scene.step(137)
        self.assertEqual(scene.time_s, told["simulated_s"])
        for body in told["bodies"]:
            self.assertEqual(
                scene.velocity_m_per_s(body["name"]).tolist(), body["velocity_m_per_s"]
            )
            self.assertEqual(scene.pose(body["name"])[:3, 3].tolist(), body["position_m"])
        self.assertEqual(len(scene.contacts()), len(told["contacts"]))
        for ours, its in zip(scene.contacts(), told["contacts"]):
            self.assertEqual(ours.force_N.tolist(), its["force_N"])
            self.assertEqual(ours.bodies, tuple(its["bodies"]))

    def test_it_moves_as_the_library_moves_it(self):
        """With the model that both recommend."""
        pad = dict(
            **softfinger.gap_between(10e-3).arguments(),
            normal_force_N=1,
            thickness_m=2e-3,
            youngs_modulus_Pa=100e3,
            poisson_ratio=0.3,
            friction_coefficient=0.5,
        )
        law = softfinger.eccentricity_law(**pad)
        ball = softfinger.Body.sphere(
            "ball", 0.01, 0.05, [0, 0, 0.01], angular_velocity_rad_per_s=[0, 0, numpy.radians(1440)]
        )
        pair = softfinger.SphereOnPlane(
            "table", "ball", 0.01, friction_coefficient=0.5, eccentricity_m=law
        )
        simulation = softfinger.Simulation([softfinger.Body.ground("table"), ball], [pair])
        with softfinger.simulate(BALL) as scene:
            scene.step(20)
            (contact,) = scene.contacts()
            self.assertEqual(contact.model, softfinger.predict(**pad).model)
            self.assertTrue(contact.slides)
            spin = scene.angular_velocity_rad_per_s("ball")[2]
        simulation.step(20)
        # Loads agree to 1e-9, and e_n is weaker than they are.
        expected = simulation.angular_velocity_rad_per_s("ball")[2]
        self.assertAlmostEqual(spin / expected, 1, delta=1e-8)

    def test_targets_hold_against_the_scenes_own(self):
        with softfinger.simulate("lift_box") as scene:
            scene.set_motor("lift", target=0.005)
            scene.step(1500)
            # The scene would have lifted by more than 30 mm by now.
            self.assertAlmostEqual(scene.joint_position("lift"), 0.005, delta=1e-3)
            self.assertGreater(scene.motor_effort("lift"), 0)
            scene.set_gravity([0, 0, 0])
            scene.step(200)
            self.assertLess(abs(scene.motor_effort("lift")), 0.1)

    def test_forces_act(self):
        with softfinger.simulate(BALL) as scene:
            scene.set_gravity([0, 0, 0])
            scene.apply_force("ball", force_N=[0, 0, 0.1])
            scene.step(10)
            self.assertAlmostEqual(
                scene.velocity_m_per_s("ball")[2], 0.1 / 0.05 * 0.01, delta=1e-12
            )

    def test_what_cannot_be_used_is_refused(self):
        with self.assertRaises(softfinger.InputError):
            softfinger.simulate("no_such_scene")
        for field, change in (
            ("motors.up", lambda scene: scene.set_motor("up", target=1)),
            ("motors.lift.goal", lambda scene: scene.set_motor("lift", goal=1)),
            ("motors.lift.damping", lambda scene: scene.set_motor("lift", damping=-1)),
            ("forces.cat", lambda scene: scene.apply_force("cat")),
            ("gravity_m_per_s2", lambda scene: scene.set_gravity([0, 0])),
        ):
            with softfinger.simulate("lift_box") as scene:
                change(scene)
                with self.assertRaisesRegex(softfinger.InputError, field + r" = .*allowed: "):
                    scene.step()
        with softfinger.simulate("lift_box") as scene:
            scene.step(10**6)
            with self.assertRaisesRegex(softfinger.InputError, "time_s = 2"):
                scene.step()
            with self.assertRaisesRegex(softfinger.InputError, "table, object, hand"):
                scene.pose("cup")


class WithoutTheProgram(unittest.TestCase):
    def test_it_is_told_how_to_get_it(self):
        with mock.patch.dict(os.environ, {"PATH": ""}):
            os.environ.pop("SOFTFINGER_PROGRAM", None)
            with self.assertRaisesRegex(softfinger.ProgramError, "comparisons/run.sh"):
                softfinger.simulate("lift_box")


if __name__ == "__main__":
    unittest.main()
