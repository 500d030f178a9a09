"""Readings of tactile arrays."""

import io
import tempfile
import unittest

import numpy

import softfinger
from samples import FAST_MODELS, PAD, needs_program
from softfinger import _program

CASE = """
id = "taxels"
[geometry]
relative_radii_mm = [20, 5]
[layer]
thickness_mm = 2
youngs_modulus_kPa = 300
poisson_ratio = 0.45
[contact]
load_N = 2
friction_coefficient = 0.8
"""


class Taxels(unittest.TestCase):
    def test_they_add_up_to_the_load(self):
        for model in FAST_MODELS:
            if model == "power_law":  # knows no measurement
                continue
            readings = softfinger.taxels(**PAD, columns=9, rows=6, model=model)
            self.assertEqual(readings.force_N.shape, (6, 9))
            self.assertEqual((readings.x_m.size, readings.y_m.size), (9, 6))
            # Rounding of some thousand cells.
            self.assertAlmostEqual(readings.force_N.sum(), 2.0, delta=1e-12)
            self.assertAlmostEqual(readings.outside_N, 0.0, delta=1e-12)
            self.assertEqual(readings.model, model)

    def test_the_pressure_of_the_library_fills_them(self):
        readings = softfinger.taxels(**PAD, columns=33, rows=33)
        middle = readings.pressure_Pa[16, 16]
        expected = softfinger.pressure_Pa(**PAD, x_m=0, y_m=0)
        # The means of x² and y² over a taxel are a twelfth of its side squared; the pressure
        # (1 - x²/a² - y²/b²)^n has n of at most 2.
        contact = softfinger.predict(**PAD)
        sides = numpy.array([readings.pitch_m / contact.a_m, readings.pitch_m / contact.b_m])
        self.assertLess(middle, expected)
        self.assertGreater(middle, expected * (1 - 2 * (sides**2).sum() / 12))
        self.assertTrue((readings.shear_x_Pa == 0).all())

    def test_savez_keeps_all_numbers(self):
        readings = softfinger.taxels(**PAD, columns=4, rows=5, pitch_m=1e-3, depth_m=2e-3)
        file = io.BytesIO()
        numpy.savez(file, **readings.arrays())
        file.seek(0)
        kept = numpy.load(file)
        self.assertEqual(set(kept), set(readings.arrays()))
        numpy.testing.assert_array_equal(kept["shear_x_Pa"], readings.shear_x_Pa)
        self.assertEqual(kept["model"], readings.model)

    def test_what_is_no_array_is_refused(self):
        good = dict(columns=4, rows=4)
        for bad in (
            dict(columns=0),
            dict(rows=65),
            dict(rows=2.5),
            dict(columns=True),
            dict(pitch_m=0),
            dict(pitch_m=float("nan")),
            dict(pitch_m=1e-6),
            dict(pitch_m=[1e-3, 2e-3]),
            dict(depth_m=-1e-3),
            dict(depth_m=2.1e-3),
        ):
            with self.assertRaises(softfinger.InputError) as raised:
                softfinger.taxels(**PAD, **{**good, **bad})
            self.assertEqual(raised.exception.argument, next(iter(bad)))
        with self.assertRaises(softfinger.InputError):
            softfinger.taxels(**{**PAD, "normal_force_N": [1.0, 2.0]}, **good)

    @needs_program
    def test_the_program_reads_the_same(self):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write(CASE)
            file.flush()
            array = ["--taxels", "7,5,1", "--taxels-depth", "1.5"]
            told = _program.run_program(["predict", file.name, *array, "--json"])
        (first,) = [result for result in told["results"] if result["model"] == "bonded_layer"]
        readings = softfinger.taxels(
            **PAD, columns=7, rows=5, pitch_m=1e-3, depth_m=1.5e-3, model="bonded_layer"
        )
        for name in ("force_N", "pressure_Pa", "shear_x_Pa", "shear_y_Pa", "displacement_m"):
            of_program = numpy.array(first["taxels"][name])
            # Lengths in mm are rounded once on their way through the case.
            numpy.testing.assert_allclose(
                of_program, getattr(readings, name), rtol=1e-9, atol=1e-12 * of_program.max()
            )


if __name__ == "__main__":
    unittest.main()
