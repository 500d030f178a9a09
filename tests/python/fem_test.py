"""Finite elements through the program."""

import os
import unittest
from unittest import mock

import numpy

import softfinger
from samples import needs_program
from softfinger import _program


class Fem(unittest.TestCase):
    def test_a_missing_program_is_told_with_how_to_get_it(self):
        with mock.patch.dict(os.environ, {"PATH": ""}):
            os.environ.pop("SOFTFINGER_PROGRAM", None)
            with self.assertRaisesRegex(softfinger.ProgramError, "comparisons/run.sh"):
                softfinger.fem("hertz_circle")

    def test_tables_are_written_as_a_case_file(self):
        case = {
            "geometry": {"finger": {"radii_mm": (12, 7)}, "object": {"radii_mm": (numpy.inf, 15)}},
            "contact": {"load_N": numpy.array([1.0, 2.0]), "friction_coefficient": 0.8},
        }
        text = _program._toml({"id": "tables", "question": 'are "they" equal?', **case})
        self.assertIn('question = "are \\"they\\" equal?"', text)
        self.assertIn("object = { radii_mm = [inf, 15] }", text)
        self.assertIn("load_N = [1.0, 2.0]", text)

    @needs_program
    def test_the_programs_refusal_is_an_input_error(self):
        case = {
            "geometry": {"relative_radii_mm": [20, 5]},
            "layer": {"thickness_mm": 2.0, "youngs_modulus_kPa": 300, "poisson_ratio": 0.7},
            "contact": {"load_N": [1.0], "friction_coefficient": 0.8},
        }
        with self.assertRaisesRegex(softfinger.InputError, r"poisson_ratio = 0\.7.*allowed"):
            softfinger.fem(case)

    @unittest.skipUnless(os.environ.get("SOFTFINGER_FEM_PROGRAM"), "no program softfinger-fem")
    def test_finite_elements_answer_within_their_stated_errors(self):
        case = {
            "geometry": {"relative_radii_mm": [20.0, 20.0]},
            "layer": {"thickness_mm": 20.0, "youngs_modulus_kPa": 500.0, "poisson_ratio": 0.3},
            "contact": {"load_N": [0.3], "friction_coefficient": 0.6},
        }
        (result,) = softfinger.fem(case, level=1)
        self.assertEqual(result.load_N, 0.3)
        self.assertEqual(result.document["kinematics"], "linear")
        model = softfinger.predict(
            normal_force_N=0.3,
            youngs_modulus_Pa=500e3,
            poisson_ratio=0.3,
            thickness_m=20e-3,
            radius_major_m=20e-3,
            radius_minor_m=20e-3,
            friction_coefficient=0.6,
            model="bonded_layer",
        )
        for name, error in (
            ("a_m", result.error.a),
            ("indentation_m", result.error.indentation),
            ("max_torque_Nm", result.error.max_torque),
        ):
            # bonded_layer itself is within 0.5 %, 1 % in the indentation.
            relative = abs(getattr(model, name) / getattr(result, name) - 1)
            self.assertLess(relative, error + 0.01, name)


if __name__ == "__main__":
    unittest.main()
