"""From triangles to radii, and from two bodies to their gap."""

import unittest

import numpy

import softfinger


def cap(radius_x_m, radius_y_m, count=25, span_m=4e-3):
    """Corners of triangles on the top of z = -(x²/(2 Rx) + y²/(2 Ry)), outside up."""
    grid = numpy.linspace(-span_m, span_m, count)
    x, y = numpy.meshgrid(grid, grid, indexing="ij")
    points = numpy.stack([x, y, -(x**2 / (2 * radius_x_m) + y**2 / (2 * radius_y_m))], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return numpy.concatenate(
        [numpy.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    )


class Fit(unittest.TestCase):
    def test_a_quadric_is_fitted_exactly(self):
        fit = softfinger.fit(cap(20e-3, 5e-3), [0, 0, 0], 3e-3)
        numpy.testing.assert_allclose(fit.radii_m, [20e-3, 5e-3], rtol=1e-9)
        numpy.testing.assert_allclose(fit.normal, [0, 0, 1], atol=1e-9)
        self.assertAlmostEqual(fit.axis_rad, 0, delta=1e-9)
        self.assertEqual(fit.outliers, 0)

    def test_shared_vertices_and_loose_triangles_give_the_same(self):
        loose = cap(9e-3, 6e-3)
        self.assertEqual(
            softfinger.fit(loose, [0, 0, 0], 3e-3),
            softfinger.fit(softfinger.weld(loose), [0, 0, 0], 3e-3),
        )

    def test_what_cannot_be_used_is_refused(self):
        surface = cap(9e-3, 6e-3)
        for argument, call in (
            ("point_m", lambda: softfinger.fit(surface, [0, 0], 1e-3)),
            ("region_radius_m", lambda: softfinger.fit(surface, [0, 0, 0], -1)),
            ("corners_m", lambda: softfinger.fit(numpy.zeros((4, 3)), [0, 0, 0], 1e-3)),
            ("triangles[0, 2]", lambda: softfinger.fit((numpy.eye(3), [[0, 1, 3]]), [0, 0, 0], 1)),
        ):
            with self.assertRaises(softfinger.InputError) as caught:
                call()
            self.assertEqual(caught.exception.argument, argument)
        # Found by the compiled part: its error is the same kind.
        with self.assertRaises(softfinger.InputError):
            softfinger.fit(surface, [0, 0, 0], 1e-6)


class Gap(unittest.TestCase):
    def test_curvatures_add(self):
        gap = softfinger.gap_between((20e-3, 5e-3), (numpy.inf, 15e-3))
        # 1/R' and 1/R'' of parallel axes.
        self.assertAlmostEqual(gap.radius_major_m * 50, 1, delta=1e-14)
        self.assertAlmostEqual(gap.radius_minor_m * (200 + 1 / 15e-3), 1, delta=1e-14)
        self.assertEqual((gap.finger_xx_per_m, gap.finger_yy_per_m), (50, 200))

    def test_fits_are_turned_into_each_other(self):
        # An object that is the finger's mirror image, at an angle: the same as by radii.
        fit = softfinger.fit(cap(20e-3, 5e-3), [0, 0, 0], 3e-3)
        turned = softfinger.fit(cap(5e-3, 20e-3), [0, 0, 0], 3e-3)
        angles = numpy.array([0.0, 0.4, 1.2])
        by_radii = softfinger.gap_between((20e-3, 5e-3), (5e-3, 20e-3), angles)
        by_fits = softfinger.gap_between(fit, turned, angles)
        for name in ("radius_major_m", "radius_minor_m", "finger_xx_per_m", "finger_yy_per_m"):
            numpy.testing.assert_allclose(
                getattr(by_fits, name), getattr(by_radii, name), rtol=1e-8, atol=1e-6
            )

    def test_no_ellipse_is_refused(self):
        for finger, other in (((numpy.inf, 5e-3), numpy.inf), (-1e-2, 2e-2), (0, 1)):
            with self.assertRaises(softfinger.InputError):
                softfinger.gap_between(finger, other)

    def test_its_arguments_are_those_of_predict(self):
        gap = softfinger.gap_between([10e-3, 12e-3])
        contact = softfinger.predict(
            **gap.arguments(),
            normal_force_N=1,
            youngs_modulus_Pa=3e5,
            poisson_ratio=0.4,
            thickness_m=2e-3,
            friction_coefficient=0.5,
        )
        self.assertEqual(contact.a_m.shape, (2,))
        self.assertTrue(contact.has_answer.all())


if __name__ == "__main__":
    unittest.main()
