"""Limit surfaces and friction ellipsoids."""

import pickle
import unittest

import numpy

import softfinger
from samples import PAD


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


if __name__ == "__main__":
    unittest.main()
