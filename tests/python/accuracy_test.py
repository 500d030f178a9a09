"""Error bounds and the choice of a model."""

import dataclasses
import tempfile
import unittest

import numpy

import softfinger
from samples import FAST_MODELS, PAD, needs_program, random_contacts
from softfinger import _accuracy, _program


class ErrorBounds(unittest.TestCase):
    def test_causes_add_up(self):
        contacts = random_contacts(50)
        for model in FAST_MODELS:
            found = softfinger.error_bound(**contacts, model=model)
            causes = (found.by_model, found.by_strain, found.by_slope, found.by_curvature)
            for quantity in ("area", "max_torque"):
                total = sum(getattr(cause, quantity) for cause in causes)
                numpy.testing.assert_allclose(
                    total, getattr(found.expected, quantity), rtol=1e-12, atol=1e-12
                )

    def test_plain_numbers_have_the_bounds_of_arrays(self):
        """Plain numbers are answered by the compiled part at once."""
        contacts = random_contacts(200)
        known = 0
        for model in (None, *FAST_MODELS):
            together = softfinger.error_bound(**contacts, model=model)
            for i in range(200):
                plain = {k: float(v[i]) for k, v in contacts.items()}
                at_once = _accuracy._bound_at_once({**plain, "model": model})
                self.assertEqual(at_once is not None, together.known[i])
                if at_once is None:
                    continue
                array = softfinger.error_bound(
                    **{k: v[i : i + 1] for k, v in contacts.items()}, model=model
                )
                for field in dataclasses.fields(at_once):
                    one, other = getattr(at_once, field.name), getattr(array, field.name)
                    if isinstance(one, softfinger.Errors):
                        one, other = (list(vars(x).values()) for x in (one, other))
                        other = [float(x[0]) for x in other]
                    else:
                        other = other[0] if isinstance(other, numpy.ndarray) else other
                    self.assertEqual(one, other, field.name)
                known += 1
        self.assertGreater(known, 300)

    def test_what_is_not_known_is_infinite_and_says_why(self):
        # A layer thicker than the runs that the bounds are from.
        found = softfinger.error_bound(**{**PAD, "thickness_m": [2e-3, 1.0]})
        self.assertEqual(found.known.tolist(), [True, False])
        self.assertEqual(found.bound.area[1], numpy.inf)
        self.assertEqual(found.by_strain.area.mask.tolist(), [False, True])
        alone = softfinger.error_bound(**{**PAD, "thickness_m": 1.0})
        self.assertEqual(
            (alone.bound.area, alone.expected, alone.usable()), (numpy.inf, None, False)
        )
        self.assertIn("thick", found.outside[1])
        self.assertEqual(found.outside[0], "")
        self.assertEqual(found.usable().tolist(), [True, False])


class Select(unittest.TestCase):
    def test_the_choice_is_the_best_of_those_that_meet_the_tolerance(self):
        contacts = random_contacts(200)
        usable = ("a", "b", "area", "max_torque")
        for tolerance in (0.02, 0.1, 0.5):
            choice = softfinger.select(**contacts, tolerance=tolerance)
            for i, name in enumerate(choice.model):
                worst = {m: bound.bound.largest(usable)[i] for m, bound in choice.bounds.items()}
                if not name:
                    self.assertGreater(min(worst.values()), tolerance)
                    continue
                self.assertLessEqual(worst[name], tolerance)
                self.assertEqual(choice.bound[i], worst[name])
                self.assertEqual(worst[name], min(worst.values()))

    def test_usable_is_what_select_chooses_by(self):
        contacts = random_contacts(200)
        bound = softfinger.error_bound(**contacts, model="bonded_layer")
        choice = softfinger.select(**contacts, models=["bonded_layer"], tolerance=0.1)
        self.assertEqual(bound.usable().tolist(), (choice.model != "").tolist())
        self.assertIn(True, bound.usable())
        self.assertIn(False, bound.usable())

    @needs_program
    def test_the_program_states_the_same_errors(self):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write(
                'id = "pad"\nquestion = "?"\n[geometry]\nrelative_radii_mm = [20, 5]\n'
                "[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n"
                "[contact]\nload_N = [2.0]\nfriction_coefficient = 0.8\n"
            )
            file.flush()
            told = _program.run_program(["select", file.name, "--tolerance", "0.05", "--json"])
        candidates = {c["model"]: c for c in told["choices"][0]["candidates"]}
        choice = softfinger.select(**PAD)
        for name, bound in choice.bounds.items():
            if candidates[name]["error_bound"] is None:
                self.assertFalse(bound.known)
                continue
            for quantity, value in candidates[name]["error_bound"].items():
                self.assertAlmostEqual(getattr(bound.bound, quantity) / value, 1, delta=1e-12)

    def test_unknown_names_are_refused(self):
        for wrong in (
            dict(models=["hertz", "herz"]),
            dict(quantities=["depth"]),
            dict(tolerance=0),
            dict(tolerance=[0.1]),
        ):
            with self.assertRaises(softfinger.InputError) as caught:
                softfinger.select(**PAD, **wrong)
            self.assertEqual(caught.exception.argument, next(iter(wrong)))


if __name__ == "__main__":
    unittest.main()
