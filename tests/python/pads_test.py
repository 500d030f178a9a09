"""Flat pads."""

import json
import os
import pickle
import subprocess
import unittest

import numpy

import softfinger
from samples import needs_program

RUBBER = dict(
    normal_force_N=20.0,
    youngs_modulus_Pa=800e3,
    poisson_ratio=0.49,
    thickness_m=3e-3,
    friction_coefficient=0.7,
)


class FlatPad(unittest.TestCase):
    def test_without_lateral_contraction_it_is_a_column(self):
        foam = dict(RUBBER, poisson_ratio=0.0)
        disc = softfinger.FlatPad.disc(20e-3).predict(**foam)
        area_m2 = numpy.pi * 10e-3**2
        self.assertAlmostEqual(disc.normal_stiffness_N_per_m / (800e3 * area_m2 / 3e-3), 1, 6)
        # Uniform pressure: 2/3 of the radius, but for the disc as a polygon.
        self.assertAlmostEqual(disc.eccentricity_m / (20e-3 / 3), 1, 3)
        self.assertAlmostEqual(disc.max_torque_Nm, 0.7 * 20 * disc.eccentricity_m, 12)

    def test_arrays_are_single_answers(self):
        pad = softfinger.FlatPad.rectangle(22e-3, 37.5e-3, 1e-3)
        ratios = numpy.array([[0.3, 0.45], [0.49, 0.4999]])
        many = pad.predict(**dict(RUBBER, poisson_ratio=ratios))
        self.assertEqual(many.eccentricity_m.shape, (2, 2))
        for index in numpy.ndindex(2, 2):
            one = pad.predict(**dict(RUBBER, poisson_ratio=ratios[index]))
            self.assertEqual(one.eccentricity_m, many.eccentricity_m[index])
            self.assertEqual(one.torque_bound, many.torque_bound[index])
        # A pad that is nearly incompressible presses harder in its middle.
        self.assertGreater(many.eccentricity_m[0, 0], many.eccentricity_m[1, 1])
        self.assertEqual(pickle.loads(pickle.dumps(many)), many)

    def test_polygons_are_what_their_corners_say(self):
        square = softfinger.FlatPad.rectangle(17e-3, 17e-3)
        same = softfinger.FlatPad.polygon(
            8.5e-3 * numpy.array([[-1, -1], [-1, 1], [1, 1], [1, -1]])
        )
        self.assertAlmostEqual(same.area_m2, 17e-3**2, 15)
        self.assertAlmostEqual(
            same.predict(**RUBBER).eccentricity_m / square.predict(**RUBBER).eccentricity_m, 1, 9
        )

    def test_bad_input_is_named(self):
        pad = softfinger.FlatPad.disc(20e-3)
        for wrong, part in (
            (dict(poisson_ratio=0.6), "poisson_ratio"),
            (dict(thickness_m=[1e-3, -1]), "thickness_m[1]"),
            (dict(model="pad_leyer"), "did you mean pad_layer"),
            (dict(pressing="glued"), "frictionless"),
            (dict(normal_force_N=[1, 2], thickness_m=[1e-3] * 3), "broadcast"),
        ):
            with self.assertRaises(softfinger.InputError) as caught:
                pad.predict(**dict(RUBBER, **wrong))
            self.assertIn(part, str(caught.exception))
        for made in (
            lambda: softfinger.FlatPad.disc(-1),
            lambda: softfinger.FlatPad.rectangle(1e-2, 1e-2, 1e-2),
            lambda: softfinger.FlatPad.polygon([[0, 0], [1, 1], [1, 0], [0, 1]]),
            lambda: softfinger.FlatPad.polygon([1, 2, 3]),
        ):
            self.assertRaises(softfinger.InputError, made)
        self.assertRaises(TypeError, softfinger.FlatPad, 1)

    @needs_program
    def test_it_says_what_the_program_says(self):
        told = json.loads(
            subprocess.run(
                [
                    *(os.environ["SOFTFINGER_PROGRAM"], "predict", "--pad-mm", "22,37.5"),
                    *("--thickness-mm", "3", "--youngs-modulus-kPa", "800"),
                    *("--poisson-ratio", "0.49", "--load", "20", "--friction", "0.7", "--json"),
                ],
                capture_output=True,
                check=True,
            ).stdout
        )
        of_program = next(one for one in told["results"] if one["model"] == "pad_layer")
        own = softfinger.FlatPad.rectangle(22e-3, 37.5e-3).predict(**RUBBER)
        for name in ("indentation_m", "eccentricity_m", "max_torque_Nm", "pressure_arm_m"):
            self.assertAlmostEqual(getattr(own, name) / of_program[name], 1, 12)


if __name__ == "__main__":
    unittest.main()
