"""Figures, drawn without a screen."""

import importlib.util
import os
import subprocess
import sys
import unittest

os.environ["MPLBACKEND"] = "Agg"
os.environ.setdefault("MPLCONFIGDIR", os.environ.get("TMPDIR", "/tmp"))

import numpy

import softfinger
import softfinger.plot
from samples import PAD

HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None


class Plot(unittest.TestCase):
    def test_matplotlib_is_not_loaded_before_a_figure_is_drawn(self):
        code = "import softfinger.plot, sys; sys.exit('matplotlib' in sys.modules)"
        subprocess.run([sys.executable, "-c", code], check=True)

    @unittest.skipUnless(HAS_MATPLOTLIB, "no matplotlib")
    def test_a_contact_is_drawn_at_equal_scale_with_its_ellipse(self):
        axes = softfinger.plot.plot_contact(**PAD)
        (ellipse,) = axes.get_lines()
        contact = softfinger.predict(**PAD)
        self.assertAlmostEqual(ellipse.get_xdata().max(), 1e3 * contact.a_m, delta=1e-12)
        self.assertAlmostEqual(ellipse.get_ydata().max(), 1e3 * contact.b_m, delta=1e-12)
        self.assertEqual(axes.get_aspect(), 1)

    @unittest.skipUnless(HAS_MATPLOTLIB, "no matplotlib")
    def test_limits_are_drawn_into_one_figure(self):
        surface = softfinger.predict(**PAD).limit_surface()
        axes = softfinger.plot.plot_limit_surface(surface, 0.3)
        softfinger.plot.plot_limit_surface(surface.ellipsoid(), 0.3, axes=axes, linestyle="--")
        exact, ellipsoid = axes.get_lines()
        for curve in (exact, ellipsoid):
            # Closed, and as far as the largest force; the torque's sampling may miss its top.
            self.assertEqual(curve.get_xdata()[0], curve.get_xdata()[-1])
            self.assertAlmostEqual(numpy.max(curve.get_xdata()), surface.max_force_N, delta=1e-12)

    @unittest.skipUnless(HAS_MATPLOTLIB, "no matplotlib")
    def test_a_calibration_is_drawn_with_its_outlier(self):
        loads_N = numpy.geomspace(0.2, 5, 8)
        truth = softfinger.predict(**{**PAD, "normal_force_N": loads_N})
        smeared_m = truth.a_m * numpy.where(
            loads_N == loads_N[5], 1.5, 1 + 0.01 * (-1) ** numpy.arange(8)
        )
        finger = {name: value for name, value in PAD.items() if name != "normal_force_N"}
        found = softfinger.calibrate(
            **finger, load_N=loads_N, a_m=smeared_m, indentation_m=truth.indentation_m
        )
        self.assertEqual([one.index for one in found.outliers], [(5,)])
        of_a, of_indentation = softfinger.plot.plot_calibration(found)
        curve, points, cross = of_a.get_lines()
        numpy.testing.assert_array_equal(curve.get_ydata(), 1e3 * found.curves["a_m"].value)
        self.assertEqual(len(points.get_xdata()), 7)
        self.assertEqual(cross.get_ydata(), [1e3 * smeared_m[5]])
        self.assertEqual(len(of_indentation.get_lines()), 2)
        with self.assertRaises(softfinger.InputError):
            softfinger.plot.plot_calibration(found, axes=of_a)
        with self.assertRaises(softfinger.InputError):
            softfinger.plot.plot_calibration(truth)

    def test_several_contacts_are_refused(self):
        with self.assertRaises(softfinger.InputError):
            softfinger.plot.plot_contact(**{**PAD, "normal_force_N": [1, 2]})


if __name__ == "__main__":
    unittest.main()
