"""Bodies in motion under Python's control, against closed forms."""

import unittest

import numpy

import softfinger
from samples import PAD

G = 9.81
BALL = {**PAD, "radius_major_m": 0.01, "radius_minor_m": 0.01, "friction_coefficient": 0.5}


def on_ground(ball, eccentricity_m=0.0, **options):
    pair = softfinger.SphereOnPlane(
        "ground", "ball", radius_m=0.01, friction_coefficient=0.5, eccentricity_m=eccentricity_m
    )
    return softfinger.Simulation([softfinger.Body.ground(), ball], [pair], **options)


class Motion(unittest.TestCase):
    def test_a_spinning_ball_is_slowed_by_the_torque_of_its_load(self):
        law = softfinger.eccentricity_law(**BALL)
        ball = softfinger.Body.sphere(
            "ball", 0.01, 0.05, [0, 0, 0.01], angular_velocity_rad_per_s=[0, 0, 20.0]
        )
        simulation = on_ground(ball, law)
        steps = 10
        simulation.step(steps)
        weight_N = 0.05 * G
        inertia = 0.4 * 0.05 * 0.01**2
        arm_m = softfinger.predict(**{**BALL, "normal_force_N": weight_N}).torque_arm_exact_m
        slower = 0.5 * weight_N * arm_m / inertia * 1e-3 * steps
        # The load and e_n(P) agree to 1e-9 in a step.
        self.assertAlmostEqual(
            simulation.angular_velocity_rad_per_s("ball")[2] / (20 - slower), 1, delta=1e-9
        )
        (contact,) = simulation.contacts()
        self.assertAlmostEqual(contact.normal_force_N / weight_N, 1, delta=1e-9)
        self.assertAlmostEqual(contact.torque_Nm / (-0.5 * weight_N * arm_m), 1, delta=1e-9)

    def test_a_ball_falls_freely_before_it_lands(self):
        ball = softfinger.Body.sphere("ball", 0.01, 0.05, [0, 0, 1.0])
        simulation = on_ground(ball)
        simulation.step(100)
        self.assertAlmostEqual(simulation.velocity_m_per_s("ball")[2], -G * 0.1, delta=1e-12)
        self.assertAlmostEqual(simulation.time_s, 0.1, delta=1e-15)

    def test_a_box_slides_to_rest_by_coulomb_friction(self):
        size = [0.02, 0.02, 0.01]
        box = softfinger.Body.box("box", size, 0.1, [0, 0, 0.005], velocity_m_per_s=[0.5, 0, 0])
        pair = softfinger.BoxOnPlane("ground", "box", size, friction_coefficient=0.3)
        simulation = softfinger.Simulation([softfinger.Body.ground(), box], [pair])
        simulation.step(100)
        self.assertAlmostEqual(
            simulation.velocity_m_per_s("box")[0], 0.5 - 0.3 * G * 0.1, delta=1e-8
        )
        simulation.step(200)
        self.assertAlmostEqual(simulation.velocity_m_per_s("box")[0], 0, delta=1e-9)

    def test_targets_are_followed(self):
        """A motor lifts a ball that lies on a moving plate: state read, target set, step by step."""
        plate = softfinger.Body("plate", mass_kg=0.2, inertia_kg_m2=1e-4 * numpy.eye(3))
        ball = softfinger.Body.sphere("ball", 0.01, 0.05, [0, 0, 0.01])
        simulation = softfinger.Simulation(
            [plate, ball],
            [softfinger.SphereOnPlane("plate", "ball", radius_m=0.01, friction_coefficient=0.5)],
            [softfinger.Joint("lift", child="plate", kind="prismatic")],
            [softfinger.Motor("lift", stiffness=1e4, damping=200)],
        )
        while simulation.time_s < 0.5:
            simulation.set_motor("lift", target=0.02 * min(1, simulation.time_s / 0.2))
            simulation.step()
        weight = 0.25 * G
        # At rest the spring carries both: it is compressed by weight over stiffness.
        self.assertAlmostEqual(simulation.joint_position("lift"), 0.02 - weight / 1e4, delta=1e-6)
        self.assertAlmostEqual(simulation.motor_effort("lift") / weight, 1, delta=1e-4)
        self.assertAlmostEqual(simulation.pose("ball")[2, 3], 0.03 - weight / 1e4, delta=1e-6)

    def test_contacts_may_be_found_by_a_function(self):
        found = []

        def find(simulation):
            height = simulation.pose("ball")[2, 3]
            found.append(height)
            return [
                softfinger.Contact(
                    "ground",
                    "ball",
                    [0, 0, 0],
                    [0, 0, 1],
                    height - 0.01,
                    0.5,
                    shape=(1.0, 0.5),
                    eccentricity_m=1e-3,
                )
            ]

        ball = softfinger.Body.sphere(
            "ball", 0.01, 0.05, [0, 0, 0.01], angular_velocity_rad_per_s=[0, 0, 20.0]
        )
        turns = []
        for friction in ("ellipsoid", "six_patches", "limit_surface"):
            simulation = softfinger.Simulation(
                [softfinger.Body.ground(), ball], find, friction=friction
            )
            simulation.step(5)
            turns.append(simulation.angular_velocity_rad_per_s("ball")[2])
        self.assertEqual(len(found), 15)
        # Pure torque: all limits agree there.
        numpy.testing.assert_allclose(turns, turns[0], rtol=1e-9)

    def test_forces_and_gravity_act(self):
        ball = softfinger.Body.sphere("ball", 0.01, 0.05, [0, 0, 1.0])
        simulation = softfinger.Simulation([ball])
        simulation.set_gravity([0, 0, 0])
        simulation.apply_force("ball", force_N=[0.1, 0, 0], torque_Nm=[0, 0, 1e-6])
        simulation.step(10)
        self.assertAlmostEqual(
            simulation.velocity_m_per_s("ball")[0], 0.1 / 0.05 * 0.01, delta=1e-15
        )
        spin = 1e-6 / (0.4 * 0.05 * 0.01**2) * 0.01
        self.assertAlmostEqual(simulation.angular_velocity_rad_per_s("ball")[2], spin, delta=1e-12)


class Errors(unittest.TestCase):
    ball = softfinger.Body.sphere("ball", 0.01, 0.05, [0, 0, 0.01])

    def test_wrong_descriptions_are_refused(self):
        body, joint = softfinger.Body, softfinger.Joint
        for argument, call in (
            ("mass_kg", lambda: body("b", mass_kg=0)),
            ("pose", lambda: body("b", pose=2 * numpy.eye(4))),
            ("kind", lambda: joint("j", "b", "hinge")),
            (
                "child",
                lambda: softfinger.Simulation([self.ball], joints=[joint("j", "c", "fixed")]),
            ),
            ("bodies", lambda: softfinger.Simulation([self.ball, self.ball])),
            ("body", lambda: softfinger.Simulation([self.ball]).pose("glass")),
            ("time_step_s", lambda: softfinger.Simulation([self.ball], time_step_s=0)),
        ):
            with self.assertRaises(softfinger.InputError, msg=argument) as caught:
                call()
            self.assertEqual(caught.exception.argument, argument)
        # What the compiled part finds: no body has such an inertia.
        with self.assertRaises(softfinger.InputError):
            softfinger.Simulation([body("b", inertia_kg_m2=numpy.diag([1.0, 1.0, 3.0]))])

    def test_those_of_the_users_function_come_through_and_nothing_moves(self):
        def find(simulation):
            raise KeyError("mine")

        simulation = softfinger.Simulation([self.ball], find)
        with self.assertRaisesRegex(KeyError, "mine"):
            simulation.step()
        self.assertEqual(simulation.time_s, 0)

    def test_steps_without_solution_are_told(self):
        def find(simulation):
            press = dict(gap_m=-1e-3, friction_coefficient=0.5)
            return [
                softfinger.Contact("floor", "slab", [0, 0, 0], [0, 0, 1], id=0, **press),
                softfinger.Contact("lid", "slab", [0, 0, 0.01], [0, 0, -1], id=1, **press),
            ]

        floor, lid = (softfinger.Body(name, fixed=True) for name in ("floor", "lid"))
        slab = softfinger.Body("slab", mass_kg=0.1)
        simulation = softfinger.Simulation([floor, lid, slab], find)
        with self.assertRaisesRegex(softfinger.StepError, "no impulses keep the bodies apart"):
            simulation.step()
        self.assertEqual(simulation.time_s, 0)


if __name__ == "__main__":
    unittest.main()
