"""Limit surfaces and friction ellipsoids."""

import json
import os
import pickle
import subprocess
import unittest

import numpy

import softfinger
from samples import PAD, needs_program


def integrated_wrench(surface, center, count=400):
    """By quadrature over the ellipse: int mu p v/|v| dA of a turn about a point, n > 0."""
    node, weight = numpy.polynomial.legendre.leggauss(count)
    r, t = numpy.meshgrid(
        0.5 * (node + 1), numpy.linspace(0, 2 * numpy.pi, 4 * count, endpoint=False)
    )
    x, y = surface.a_m * r * numpy.cos(t), surface.b_m * r * numpy.sin(t)
    n = surface.exponent
    density = surface.max_force_N * (n + 1) / numpy.pi * (1 - r**2) ** n
    measure = density * r * 0.5 * weight * 2 * numpy.pi / (4 * count)
    vx, vy = -(y - center[1]), x - center[0]
    speed = numpy.hypot(vx, vy)
    fx, fy = vx / speed, vy / speed
    return numpy.array(
        [(fx * measure).sum(), (fy * measure).sum(), ((x * fy - y * fx) * measure).sum()]
    )


class LimitSurface(unittest.TestCase):
    surface = softfinger.LimitSurface(4e-3, 2e-3, 0.6, 1.6)

    def test_largest_torques_of_circles_are_the_known_ones(self):
        # Uniform 2/3, Hertz 3 pi/16, Winkler 8/15 of the radius times mu P.
        for exponent, arm in ((0, 2 / 3), (0.5, 3 * numpy.pi / 16), (1, 8 / 15)):
            circle = softfinger.LimitSurface(3e-3, 3e-3, exponent, 2.0)
            self.assertAlmostEqual(circle.max_torque_Nm, arm * 3e-3 * 2, delta=1e-16)

    def test_wrenches_equal_integrals_over_the_ellipse(self):
        for center in ((1e-3, 0.5e-3), (-2e-3, 3e-3), (8e-3, 1e-3)):
            difference = self.surface.wrench_for_center_of_rotation(center) - integrated_wrench(
                self.surface, center
            )
            # The direction jumps at the centre, where the quadrature is of first order.
            scaled = difference / (1.6 * numpy.array([1, 1, 2e-3]))
            self.assertLess(numpy.abs(scaled).max(), 2e-5)

    def test_twists_are_normals_of_the_surface(self):
        twists = numpy.random.default_rng(3).normal(size=(2, 30, 3)) * [1, 1, 500]
        wrenches = self.surface.wrench_for_twist(twists)
        self.assertEqual(wrenches.shape, (2, 30, 3))
        power = (wrenches * twists).sum(axis=-1)
        numpy.testing.assert_allclose(self.surface.support(twists), power, rtol=1e-12)
        # Maximum dissipation: no other wrench of the surface does more.
        others = self.surface.sample(200)
        self.assertTrue((twists @ others.T <= power[..., None] * (1 + 1e-12)).all())
        numpy.testing.assert_allclose(self.surface.utilisation(wrenches), 1, rtol=1e-11)

    def test_projections_can_be_carried(self):
        loads = numpy.random.default_rng(4).normal(size=(20, 3)) * [3, 3, 6e-3]
        held = self.surface.project(loads)
        self.assertTrue((self.surface.utilisation(held) <= 1 + 1e-11).all())
        inside = self.surface.contains(loads)
        numpy.testing.assert_array_equal(held[inside], loads[inside])

    def test_a_prediction_has_the_surface_with_its_torque(self):
        contact = softfinger.predict(**PAD)
        surface = contact.limit_surface()
        self.assertAlmostEqual(surface.max_torque_Nm / contact.max_torque_Nm, 1, delta=1e-12)
        ellipsoid = contact.friction_ellipsoid()
        self.assertEqual(ellipsoid.max_torque_Nm, contact.max_torque_Nm)

    def test_arguments_out_of_range_are_refused(self):
        for wrong in (
            (0, 1, 0, 1),
            (1, 2, 0, 1),
            (1, 1, -1, 1),
            (1, 1, 0, -1),
            (1, numpy.nan, 0, 1),
        ):
            with self.assertRaises(softfinger.InputError):
                softfinger.LimitSurface(*wrong)
        for wrong in ([1, 2], [1, 2, numpy.nan], "x"):
            with self.assertRaises(softfinger.InputError):
                self.surface.utilisation(wrong)
        with self.assertRaises(softfinger.InputError):
            self.surface.sample(0)

    def test_it_survives_pickling(self):
        again = pickle.loads(pickle.dumps(self.surface))
        self.assertEqual(again, self.surface)
        self.assertEqual(
            repr(again), "LimitSurface(a_m=0.004, b_m=0.002, exponent=0.6, max_force_N=1.6)"
        )


class FrictionEllipsoid(unittest.TestCase):
    def test_utilisation_is_the_norm_of_the_scaled_wrench(self):
        ellipsoid = softfinger.FrictionEllipsoid(numpy.array([[1.6], [2.0]]), 1.8e-3)
        load = numpy.random.default_rng(5).normal(size=(2, 7, 3)) * [1, 1, 1e-3]
        used = ellipsoid.utilisation(load)
        force = numpy.array([1.6, 2.0])[:, None]
        expected = numpy.sqrt(
            (load[..., 0] ** 2 + load[..., 1] ** 2 + (load[..., 2] / 1.8e-3) ** 2) / force**2
        )
        numpy.testing.assert_allclose(used, expected, rtol=1e-14)

    def test_its_section_lies_on_it(self):
        ellipsoid = softfinger.FrictionEllipsoid(1.6, 1.8e-3)
        points = ellipsoid.sample_section(0.3, 24)
        numpy.testing.assert_allclose(ellipsoid.utilisation(points), 1, rtol=1e-14)

    def test_largest_torques_of_a_uniform_strength_are_the_known_ones(self):
        # tau_0 pi a² and, about the centre, two thirds of the radius times it.
        ellipsoid = softfinger.FrictionEllipsoid.of_shear_law(
            3e-3, 3e-3, [0.5, 1.0], 2.0, "shear_strength", shear_strength_Pa=40e3
        )
        force_N = 40e3 * numpy.pi * 3e-3**2
        numpy.testing.assert_allclose(ellipsoid.max_force_N, force_N, rtol=1e-13)
        numpy.testing.assert_allclose(ellipsoid.eccentricity_m, 2e-3, rtol=1e-13)

    def test_what_a_shear_law_needs_is_asked_for_and_nothing_else(self):
        ellipse = (3e-3, 2e-3, 0.5, 2.0)
        for law, numbers in (
            ("coulomb", dict(friction_coefficient=0.8, shear_strength_Pa=1e4)),
            ("shear_strength", dict(friction_coefficient=0.8, shear_strength_Pa=1e4)),
            ("limited", dict(friction_coefficient=0.8, shear_strength_Pa=-1.0)),
            ("viscous", dict(friction_coefficient=0.8)),
        ):
            for make in (softfinger.FrictionEllipsoid.of_shear_law, softfinger.ShearSurface):
                with self.assertRaises(softfinger.InputError):
                    make(*ellipse, law, **numbers)
            contact = {k: v for k, v in PAD.items() if k != "friction_coefficient"}
            with self.assertRaises(softfinger.InputError):
                softfinger.predict(**contact, shear_law=law, **numbers)
        for law in ("coulomb", "limited", "adhesive_shear"):
            with self.assertRaisesRegex(
                softfinger.InputError, "friction_coefficient: allowed: a number"
            ):
                softfinger.ShearSurface(*ellipse, law)
        with self.assertRaisesRegex(softfinger.InputError, "shear_strength_Pa: allowed: a number"):
            softfinger.predict(**PAD, shear_law="limited")


#: Each law with its numbers.
LAWS = (
    ("coulomb", dict(friction_coefficient=0.8)),
    ("shear_strength", dict(shear_strength_Pa=30e3)),
    ("limited", dict(friction_coefficient=0.8, shear_strength_Pa=30e3)),
    ("adhesive_shear", dict(friction_coefficient=0.8, shear_strength_Pa=30e3)),
)
PRESSED = {k: v for k, v in PAD.items() if k != "friction_coefficient"}


class ShearLaws(unittest.TestCase):
    @needs_program
    def test_predictions_are_those_of_the_program(self):
        for law, numbers in LAWS:
            keys = {"friction_coefficient": ("friction_coefficient", 1)}
            keys["shear_strength_Pa"] = ("shear_strength_kPa", 1e-3)
            contact = {keys[name][0]: value * keys[name][1] for name, value in numbers.items()}
            lines = [f"{name} = {value!r}" for name, value in contact.items()]
            case = "\n".join(
                ['id = "law"', 'question = "which torque?"', "[geometry]"]
                + ["relative_radii_mm = [20.0, 5.0]", "[layer]", "thickness_mm = 2.0"]
                + ["youngs_modulus_kPa = 300.0", "poisson_ratio = 0.45", "[contact]"]
                + ["load_N = [2.0]", f'shear_law = "{law}"', *lines]
            )
            run = subprocess.run(
                [os.environ["SOFTFINGER_PROGRAM"], "predict", "-", "--model", "fingertip_layer"]
                + ["--limit-surface", "50", "--json"],
                input=case,
                text=True,
                capture_output=True,
                check=True,
            )
            (told,) = json.loads(run.stdout)["results"]
            ours = softfinger.predict(**PRESSED, shear_law=law, **numbers)
            # Radii and moduli of the case go through mm and kPa: a few roundings.
            for name in ("a_m", "max_force_N", "max_torque_Nm", "eccentricity_m"):
                self.assertAlmostEqual(getattr(ours, name) / told[name], 1, delta=1e-13, msg=law)
            surface = ours.limit_surface()
            points = numpy.array(
                [[p["fx_N"], p["fy_N"], p["torque_Nm"]] for p in told["limit_surface"]]
            )
            scale = [ours.max_force_N, ours.max_force_N, ours.max_torque_Nm]
            # Discs are summed to 1e-9.
            numpy.testing.assert_allclose(surface.sample(50) / scale, points / scale, atol=1e-9)
            numpy.testing.assert_allclose(surface.utilisation(points), 1, rtol=1e-8)

    def test_surfaces_and_ellipsoids_have_the_prediction_s_largest_force_and_torque(self):
        for law, numbers in LAWS:
            contact = softfinger.predict(**PRESSED, shear_law=law, **numbers)
            surface, ellipsoid = contact.limit_surface(), contact.friction_ellipsoid()
            for limit in (surface, ellipsoid):
                for name in ("max_force_N", "max_torque_Nm"):
                    ratio = getattr(limit, name) / getattr(contact, name)
                    self.assertAlmostEqual(ratio, 1, delta=1e-12, msg=law)
            self.assertEqual(type(surface).__name__ == "LimitSurface", law == "coulomb")
            self.assertEqual(pickle.loads(pickle.dumps(surface)), surface)
            directions = numpy.random.default_rng(6).normal(size=(3, 5, 3)) * [1, 1, 500]
            wrenches = surface.wrench_for_twist(directions)
            power = (wrenches * directions).sum(axis=-1)
            numpy.testing.assert_allclose(surface.support(directions), power, rtol=1e-12)

    def test_arrays_of_strengths_broadcast_with_contacts(self):
        strengths_Pa = numpy.array([[10e3], [30e3], [1e9]])
        pad = {**PRESSED, "normal_force_N": [0.5, 2.0]}
        together = softfinger.predict(
            **pad, friction_coefficient=0.8, shear_strength_Pa=strengths_Pa, shear_law="limited"
        )
        self.assertEqual(together.max_torque_Nm.shape, (3, 2))
        alone = softfinger.predict(
            **PRESSED, friction_coefficient=0.8, shear_strength_Pa=30e3, shear_law="limited"
        )
        self.assertEqual(together.max_torque_Nm[1, 1], alone.max_torque_Nm)
        # A strength that is never reached leaves Coulomb's law.
        coulomb = softfinger.predict(**pad, friction_coefficient=0.8)
        numpy.testing.assert_allclose(together.max_torque_Nm[2], coulomb.max_torque_Nm, rtol=1e-12)

    def test_no_answer_has_no_friction_either(self):
        contact = softfinger.predict(
            **{**PRESSED, "poisson_ratio": [0.45, 0.5]},
            model="winkler",
            shear_law="shear_strength",
            shear_strength_Pa=30e3,
        )
        self.assertEqual(contact.has_answer.tolist(), [True, False])
        self.assertGreater(contact.max_force_N[0], 0)
        self.assertEqual(contact.max_force_N.mask.tolist(), [False, True])
        self.assertEqual(contact.max_torque_Nm.mask.tolist(), [False, True])


if __name__ == "__main__":
    unittest.main()
