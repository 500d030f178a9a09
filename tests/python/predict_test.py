"""Predictions: shapes, the program's own bits, errors, results as data."""

import copy
import pickle
import sys
import tempfile
import threading
import time
import unittest

import numpy

import softfinger
from samples import FAST_MODELS, PAD, needs_program, random_contacts
from softfinger import _core, _program
from softfinger._contacts import NUMBERS, Contacts

CASE = """
id = "from_a_test"
question = "the same bits?"
[geometry]
{geometry}
[layer]
thickness_mm = 1.7
youngs_modulus_kPa = 310
poisson_ratio = 0.43
[contact]
load_N = [0.05, 0.7, 5.0]
friction_coefficient = 0.7
"""


def told_by_the_program(geometry):
    """Of all fast models, and the contact of each of their answers as our arguments."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(CASE.format(geometry=geometry))
        file.flush()
        told = _program.run_program(["predict", file.name, "--json"])
    for result in told["results"]:
        shape = next(g for g in told["geometry"] if g["load_N"] == result["load_N"])
        arguments = {
            **told["layer"],
            "radius_major_m": shape["radii_m"][0],
            "radius_minor_m": shape["radii_m"][1],
            "normal_force_N": result["load_N"],
            "friction_coefficient": told["friction_coefficient"],
        }
        yield result, arguments


NUMBERS_TOLD = ("a_m", "b_m", "indentation_m", "peak_pressure_Pa", "max_torque_Nm")


class Broadcasting(unittest.TestCase):
    def test_numbers_give_numbers(self):
        contact = softfinger.predict(**PAD)
        self.assertIsInstance(contact.a_m, float)
        self.assertIs(contact.has_answer, True)

    def test_arrays_broadcast_against_each_other(self):
        loads, thickness = numpy.array([[0.5], [2.0], [3.0]]), numpy.array([1e-3, 2e-3])
        for model in FAST_MODELS:
            together = softfinger.predict(
                **{**PAD, "normal_force_N": loads, "thickness_m": thickness}, model=model
            )
            self.assertEqual(together.max_torque_Nm.shape, (3, 2))
            for i in range(3):
                for j in range(2):
                    single = softfinger.predict(
                        **{**PAD, "normal_force_N": loads[i, 0], "thickness_m": thickness[j]},
                        model=model,
                    )
                    self.assertEqual(together.a_m[i, j], single.a_m, model)
                    self.assertEqual(together.max_torque_Nm[i, j], single.max_torque_Nm, model)

    def test_no_contacts_give_none(self):
        empty = softfinger.predict(**{**PAD, "normal_force_N": numpy.empty((0, 3))})
        self.assertEqual(empty.a_m.shape, (0, 3))

    def test_views_and_other_types_are_numbers_too(self):
        loads = numpy.arange(1, 11, dtype=numpy.float32)[::3]
        self.assertEqual(
            softfinger.predict(**{**PAD, "normal_force_N": loads}).a_m.tolist(),
            softfinger.predict(**{**PAD, "normal_force_N": [1, 4, 7, 10]}).a_m.tolist(),
        )

    def test_inputs_are_not_changed(self):
        contacts = random_contacts(9)
        before = copy.deepcopy(contacts)
        softfinger.predict_with_gradient(**contacts)
        for name, values in contacts.items():
            numpy.testing.assert_array_equal(values, before[name])


class SameBits(unittest.TestCase):
    def test_a_batch_has_those_of_single_contacts(self):
        contacts = random_contacts(101)
        for model in FAST_MODELS:
            together = softfinger.predict(**contacts, model=model)
            for i in range(101):
                single = softfinger.predict(**{k: v[i] for k, v in contacts.items()}, model=model)
                self.assertEqual(together.a_m[i], single.a_m)
                self.assertEqual(together.indentation_m[i], single.indentation_m)

    @needs_program
    def test_the_program_predicts_the_same(self):
        compared = 0
        for result, arguments in told_by_the_program("relative_radii_mm = [20, 5]"):
            contact = softfinger.predict(**arguments, model=result["model"])
            if not contact.has_answer:
                self.assertIsNone(result["a_m"])
                continue
            for name in NUMBERS_TOLD:
                self.assertEqual(getattr(contact, name), result[name], f"{result['model']} {name}")
                compared += 1
        self.assertGreater(compared, 60)

    @needs_program
    def test_the_program_says_the_same_of_two_bodies(self):
        bodies = """finger = { radii_mm = [12, 7] }
                    object = { radii_mm = [inf, 15] }
                    angle_deg = 30"""
        gap = softfinger.gap_between((12e-3, 7e-3), (numpy.inf, 15e-3), numpy.radians(30))
        for result, arguments in told_by_the_program(bodies):
            # The program finds the gap by another function: it is the same to rounding.
            for name in ("radius_major_m", "radius_minor_m"):
                self.assertAlmostEqual(getattr(gap, name) / arguments[name], 1, delta=1e-14)
            arguments.update(gap.arguments(), model=result["model"])
            contact = softfinger.predict(**arguments)
            for name in NUMBERS_TOLD if contact.has_answer else ():
                self.assertAlmostEqual(getattr(contact, name) / result[name], 1, delta=1e-13)
            if result["error_bound"] is None:
                continue
            bound = softfinger.error_bound(**arguments)
            for quantity, value in result["error_bound"].items():
                self.assertAlmostEqual(getattr(bound.bound, quantity) / value, 1, delta=1e-12)
            self.assertEqual(bound.usable(0.1), result["usable"], result["model"])


class Errors(unittest.TestCase):
    def refused(self, **arguments):
        with self.assertRaises(softfinger.InputError) as caught:
            softfinger.predict(**{**PAD, **arguments})
        return caught.exception

    def test_they_name_argument_value_and_range(self):
        error = self.refused(poisson_ratio=[0.3, 0.7])
        self.assertIsInstance(error, ValueError)
        self.assertEqual(error.argument, "poisson_ratio[1]")
        self.assertEqual(error.value, 0.7)
        self.assertEqual(error.allowed, "0 to 0.5")
        self.assertEqual(str(error), "predict: poisson_ratio[1] = 0.7: allowed: 0 to 0.5")

    def test_every_number_has_a_range(self):
        for number in NUMBERS:
            for broken in ("wrong", numpy.nan, -numpy.inf, None, 1j, [True]):
                error = self.refused(**{number.name: broken})
                self.assertEqual(error.argument, number.name)
                self.assertTrue(error.allowed)

    def test_places_in_broadcast_arrays_are_those_of_the_result(self):
        error = self.refused(radius_major_m=[[1e-2], [2e-3]], radius_minor_m=[1e-3, 3e-3])
        self.assertEqual(error.argument, "radius_minor_m[1, 1]")
        self.assertEqual(error.value, 3e-3)

    def test_shapes_that_do_not_fit_are_named(self):
        error = self.refused(normal_force_N=[1, 2], thickness_m=[1e-3] * 3)
        self.assertIn("normal_force_N (2,), thickness_m (3,)", str(error))

    def test_unknown_models_and_arguments_are_refused(self):
        self.assertIn("bonded_layer", str(self.refused(model="bonded")))
        with self.assertRaisesRegex(TypeError, r"^predict\(\) .*thickness_mm"):
            softfinger.predict(**PAD, thickness_mm=2)

    def test_an_object_layer_needs_a_modulus(self):
        error = self.refused(object_thickness_m=1e-3)
        self.assertEqual(error.argument, "object_youngs_modulus_Pa")

    def test_they_survive_pickling(self):
        error = self.refused(poisson_ratio=0.7)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.value), (str(error), 0.7))


class Results(unittest.TestCase):
    def test_they_survive_pickling(self):
        for arguments in (PAD, random_contacts(5)):
            results = [
                softfinger.predict(**arguments),
                softfinger.predict_with_gradient(**arguments),
                softfinger.error_bound(**arguments),
                softfinger.select(**arguments),
            ]
            for result in results:
                self.assertEqual(pickle.loads(pickle.dumps(result)), result)

    def test_they_differ_where_a_number_does(self):
        self.assertNotEqual(
            softfinger.predict(**PAD), softfinger.predict(**{**PAD, "thickness_m": 2.1e-3})
        )

    def test_their_text_names_the_numbers(self):
        text = repr(softfinger.predict(**PAD))
        self.assertRegex(text, r"^Prediction\(model='fingertip_layer', has_answer=True, a_m=0\.00")

    def test_no_answer_is_zero_and_says_why(self):
        stiff = {**PAD, "poisson_ratio": [0.4, 0.5]}
        contact = softfinger.predict(**stiff, model="winkler")
        self.assertEqual(contact.has_answer.tolist(), [True, False])
        self.assertEqual(contact.a_m[1], 0)
        failing = softfinger.checks(**{**PAD, "poisson_ratio": 0.5}, model="winkler")
        self.assertTrue(any(not check.holds and check.message for check in failing))

    def test_what_a_double_cannot_hold_is_no_answer(self):
        huge = {**PAD, "normal_force_N": 1e200, "friction_coefficient": [0.5, 1e200]}
        for model in ("hertz", "winkler"):
            contact = softfinger.predict(**huge, model=model)
            self.assertEqual(contact.has_answer.tolist(), [True, False])
            self.assertEqual((contact.max_force_N[1], contact.max_torque_Nm[1]), (0, 0))
            alone = softfinger.checks(**{**huge, "friction_coefficient": 1e200}, model=model)
            self.assertEqual([c.name for c in alone if not c.holds], ["representable"])

    def test_two_layers_are_answered_one_by_one(self):
        # Two equal half-spaces share the load: half the modulus (Johnson, Contact Mechanics, 4.2).
        twice = softfinger.predict(
            **PAD,
            model="hertz",
            object_thickness_m=PAD["thickness_m"],
            object_youngs_modulus_Pa=PAD["youngs_modulus_Pa"],
            object_poisson_ratio=PAD["poisson_ratio"],
        )
        half = softfinger.predict(**{**PAD, "youngs_modulus_Pa": 150e3}, model="hertz")
        self.assertAlmostEqual(twice.a_m / half.a_m, 1, delta=1e-14)

    def test_pressure_integrates_to_the_load(self):
        contact = softfinger.predict(**PAD)
        # Gauss-Legendre in the radius, evenly spaced angles: exact to 1e-9 for this pressure.
        node, weight = numpy.polynomial.legendre.leggauss(60)
        r, t = numpy.meshgrid(0.5 * (node + 1), numpy.linspace(0, 2 * numpy.pi, 32, endpoint=False))
        pressure = softfinger.pressure_Pa(
            **PAD, x_m=contact.a_m * r * numpy.cos(t), y_m=contact.b_m * r * numpy.sin(t)
        )
        load = (pressure * r * 0.5 * weight).sum() * contact.a_m * contact.b_m * 2 * numpy.pi / 32
        self.assertAlmostEqual(load / PAD["normal_force_N"], 1, delta=1e-5)


class OtherThreads(unittest.TestCase):
    def test_they_run_during_a_batch(self):
        """With an endless switch interval only a call that lets go of the lock lets others run."""
        names = [number.name for number in NUMBERS]
        defaults = {n.name: n.default for n in NUMBERS}
        columns = {**defaults, **random_contacts(200_000)}
        numbers = Contacts.of("test", {name: columns[name] for name in names}).numbers
        state = []
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1e6)

        def work():
            state.append("begun")
            _core.predict("fingertip_layer", numbers)
            state.append("done")

        try:
            worker = threading.Thread(target=work)
            worker.start()
            seen = set()
            while worker.is_alive():
                seen.add(tuple(state))
                time.sleep(0)
            worker.join()
        finally:
            sys.setswitchinterval(interval)
        self.assertIn(("begun",), seen)


if __name__ == "__main__":
    unittest.main()
