"""Predictions: shapes, the program's own bits, errors, results as data."""

import copy
import dataclasses
import pickle
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy

import softfinger
from samples import FAST_MODELS, PAD, needs_program, random_contacts
from softfinger import _core, _predict, _program
from softfinger import _contacts
from softfinger._contacts import Contacts

CASE = """
id = "from_a_test"
question = "the same bits?"
[geometry]
{geometry}
[layer]
{layer}
[contact]
load_N = {loads_N}
friction_coefficient = 0.7
"""


LAYER = {"thickness_mm": 1.7, "youngs_modulus_kPa": 310, "poisson_ratio": 0.43}


def told_by_the_program(geometry, layer=LAYER, loads_N=(0.05, 0.7, 5.0)):
    """Of all fast models, and the contact of each of their answers as our arguments."""
    keys = "\n".join(f"{name} = {float(value)!r}" for name, value in layer.items())
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(CASE.format(geometry=geometry, layer=keys, loads_N=list(map(float, loads_N))))
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


def _python_type(value):
    return type(value.item()) if isinstance(value, numpy.generic) else type(value)


NUMBERS = ("a_m", "b_m", "indentation_m", "area_m2", "peak_pressure_Pa", "max_torque_Nm")
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
                    if not together.has_answer[i, j]:
                        continue
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
                alone = {k: v[i] for k, v in contacts.items()}
                if not together.has_answer[i]:
                    with self.assertRaises(softfinger.NoAnswer):
                        softfinger.predict(**alone, model=model)
                    continue
                single = softfinger.predict(**alone, model=model)
                for name in NUMBERS:
                    self.assertEqual(getattr(together, name)[i], getattr(single, name), name)

    def test_plain_numbers_have_those_of_arrays(self):
        """Plain numbers are answered by the compiled part at once, all others one by one in Python."""
        contacts = random_contacts(300)
        for model in (None, *FAST_MODELS):
            for i in range(300):
                plain = {k: float(v[i]) for k, v in contacts.items()}
                array = {k: v[i : i + 1] for k, v in contacts.items()}
                together = softfinger.predict(**array, model=model)
                if not together.has_answer[0]:
                    continue
                at_once = _predict._predict_at_once({**plain, "model": model})
                self.assertIsNotNone(at_once)
                for field in dataclasses.fields(at_once):
                    value = getattr(together, field.name)
                    value = value[0] if isinstance(value, numpy.ndarray) else value
                    self.assertEqual(getattr(at_once, field.name), value, field.name)
                    self.assertIs(type(getattr(at_once, field.name)), _python_type(value))

    @needs_program
    def test_the_program_predicts_the_same(self):
        compared = 0
        for result, arguments in told_by_the_program("relative_radii_mm = [20, 5]"):
            if result["a_m"] is None:
                with self.assertRaises(softfinger.NoAnswer):
                    softfinger.predict(**arguments, model=result["model"])
                continue
            contact = softfinger.predict(**arguments, model=result["model"])
            for name in NUMBERS_TOLD:
                self.assertEqual(getattr(contact, name), result[name], f"{result['model']} {name}")
                compared += 1
        self.assertGreater(compared, 60)

    @needs_program
    def test_the_program_predicts_the_same_of_fifty_random_contacts(self):
        random = numpy.random.default_rng(58)
        for _ in range(50):
            radii = sorted(numpy.exp(random.uniform(1, 4, 2)), reverse=True)
            told = told_by_the_program(
                f"relative_radii_mm = {[float(r) for r in radii]}",
                {
                    "thickness_mm": random.uniform(0.5, 6),
                    "youngs_modulus_kPa": random.uniform(50, 2000),
                    "poisson_ratio": random.uniform(0.2, 0.5),
                },
                [random.uniform(0.05, 20)],
            )
            recommended = 0
            for result, arguments in told:
                if result["a_m"] is None:
                    continue
                by_name = softfinger.predict(**arguments, model=result["model"])
                for name in NUMBERS_TOLD:
                    self.assertEqual(getattr(by_name, name), result[name], result["model"])
                if result.get("recommended"):
                    recommended += 1
                    self.assertEqual(softfinger.predict(**arguments), by_name)
            self.assertEqual(recommended, 1)

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
            if result["a_m"] is None:
                continue
            contact = softfinger.predict(**arguments)
            for name in NUMBERS_TOLD:
                self.assertAlmostEqual(getattr(contact, name) / result[name], 1, delta=1e-13)
            if result["error_bound"] is None:
                continue
            bound = softfinger.error_bound(**arguments)
            for quantity, value in result["error_bound"].items():
                self.assertAlmostEqual(getattr(bound.bound, quantity) / value, 1, delta=1e-12)
            self.assertEqual(bound.usable(0.1), result["usable"], result["model"])


class Pressing(unittest.TestCase):
    def test_friction_makes_the_contact_smaller_and_leaves_the_torque(self):
        loose = softfinger.predict(**PAD, pressing="frictionless")
        rubbed, stuck = softfinger.predict(**PAD), softfinger.predict(**PAD, pressing="stuck")
        self.assertEqual([x.pressing for x in (loose, rubbed, stuck)], list(_contacts.PRESSINGS))
        for name in ("a_m", "b_m", "indentation_m", "pressure_arm_m"):
            self.assertGreater(getattr(loose, name), getattr(rubbed, name), name)
            self.assertGreaterEqual(getattr(rubbed, name), getattr(stuck, name), name)
        self.assertGreater(rubbed.peak_pressure_Pa, loose.peak_pressure_Pa)
        for pressed in (rubbed, stuck):
            self.assertEqual(pressed.max_torque_Nm, loose.max_torque_Nm)
            self.assertEqual(
                (pressed.frictionless_a_m, pressed.frictionless_b_m), (loose.a_m, loose.b_m)
            )
            # Discs are summed to 1e-9.
            numpy.testing.assert_allclose(
                pressed.limit_surface().sample(20), loose.limit_surface().sample(20), rtol=1e-12
            )

    def test_models_that_do_not_know_it_say_so(self):
        arrays = {**PAD, "normal_force_N": [0.5, 2.0]}
        knowing = [
            name for name, card in softfinger.models().items() if card.knows_pressing_friction
        ]
        self.assertEqual(softfinger.predict(**PAD, model="hertz").pressing, "frictionless")
        self.assertNotIn("hertz", knowing)
        self.assertIn(
            "frictionless_pressing", [c.name for c in softfinger.checks(**PAD, model="hertz")]
        )
        self.assertNotIn("frictionless_pressing", [c.name for c in softfinger.checks(**PAD)])
        found = softfinger.predict(**arrays).pressing
        self.assertEqual(found.tolist(), ["coulomb"] * 2)
        two_layers = dict(object_thickness_m=[0.0, 1e-3], object_youngs_modulus_Pa=1e6)
        found = softfinger.predict(**PAD, **two_layers)
        self.assertEqual(found.pressing.tolist(), ["coulomb", "frictionless"])

    def test_the_recommended_models_know_it(self):
        contacts = random_contacts(2000)
        for name in set(softfinger.predict(**contacts).model):
            self.assertTrue(softfinger.models()[name].knows_pressing_friction, name)

    def test_pressure_has_the_load_and_the_arm_of_the_pressed_contact(self):
        contact = softfinger.predict(**PAD)
        # Rings of the ellipse, finer towards the edge, where the pressure falls steeply.
        nodes, weights = numpy.polynomial.legendre.leggauss(60)
        turn = 0.5 * numpy.pi * (nodes + 1)
        radius, ring = numpy.sin(0.5 * turn), 0.25 * numpy.pi * weights * numpy.cos(0.5 * turn)
        angle = 2 * numpy.pi * numpy.arange(64) / 64
        x = contact.a_m * numpy.outer(radius, numpy.cos(angle))
        y = contact.b_m * numpy.outer(radius, numpy.sin(angle))
        area = numpy.outer(
            ring * radius, numpy.full(64, contact.area_m2 / numpy.pi * 2 * numpy.pi / 64)
        )
        pressure = softfinger.pressure_Pa(**PAD, x_m=x, y_m=y)
        load_N = numpy.sum(pressure * area)
        arm_m = numpy.sum(pressure * numpy.hypot(x, y) * area) / load_N
        # The exponent by its formula, 2e-8.
        self.assertAlmostEqual(load_N / PAD["normal_force_N"], 1, delta=1e-6)
        self.assertAlmostEqual(arm_m / contact.pressure_arm_m, 1, delta=1e-6)

    def test_what_is_not_known_is_refused(self):
        with self.assertRaisesRegex(softfinger.InputError, "pressing = 'glued': allowed: .*stuck"):
            softfinger.predict(**PAD, pressing="glued")
        smooth = {name: x for name, x in PAD.items() if name != "friction_coefficient"}
        with self.assertRaisesRegex(softfinger.InputError, "'frictionless' with another shear law"):
            softfinger.predict(
                **smooth, shear_law="shear_strength", shear_strength_Pa=3e4, pressing="stuck"
            )


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
        for number in _contacts.NUMBERS:
            for broken in ("wrong", numpy.nan, -numpy.inf, None, 1j, [True]):
                if broken is None and number.default is None:
                    continue
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
        self.assertRegex(str(self.refused(model="bonded")), "did you mean bonded_layer[?]$")
        with self.assertRaisesRegex(
            TypeError, r"^predict\(\) .*'thickness_mm'; did you mean thickness_m\?$"
        ):
            softfinger.predict(**PAD, thickness_mm=2)
        with self.assertRaisesRegex(TypeError, r"^predict\(\) .*'normal_force_N'"):
            softfinger.predict(**{k: v for k, v in PAD.items() if k != "normal_force_N"})

    def test_names_that_are_not_there_name_the_nearest_one(self):
        for wrong, meant in (
            (lambda: softfinger.predct, "predict"),
            (lambda: softfinger.limit_surface, "LimitSurface"),
            (lambda: softfinger.predict(**PAD).max_torque, "max_torque_Nm"),
            (lambda: softfinger.error_bound(**PAD).bounds, "bound"),
        ):
            with self.assertRaisesRegex(AttributeError, rf"did you mean {meant}\?$"):
                wrong()
        with self.assertRaisesRegex(TypeError, r"'angle_deg'; did you mean angle_rad\?$"):
            softfinger.gap_between(0.01, angle_deg=3)
        self.assertFalse(hasattr(softfinger, "nothing_like_this"))

    def test_an_object_layer_needs_a_modulus(self):
        error = self.refused(object_thickness_m=1e-3)
        self.assertEqual(error.argument, "object_youngs_modulus_Pa")

    def test_they_survive_pickling(self):
        error = self.refused(poisson_ratio=0.7)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.value), (str(error), 0.7))


class Units(unittest.TestCase):
    """What is unusual is answered, with one warning."""

    def warned(self, function=softfinger.predict, **arguments):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            answer = function(**{**PAD, **arguments})
        return answer, caught

    def test_millimetres_in_place_of_metres_are_named_with_what_is_usual(self):
        contact, (warning,) = self.warned(radius_major_m=20, radius_minor_m=5, thickness_m=2)
        self.assertIs(warning.category, UserWarning)
        self.assertEqual(warning.filename, __file__)
        self.assertRegex(
            str(warning.message), r"^predict: thickness_m = 2 \(usual: 10 um to 100 mm\)"
        )
        self.assertIn("radius_major_m = 20 (usual: 0.05 mm to 10 m)", str(warning.message))
        self.assertGreater(contact.a_m, 0)

    def test_every_number_with_a_unit_has_its_usual_range(self):
        for name, low, high in (
            ("normal_force_N", 1e-4, 1e4),
            ("youngs_modulus_Pa", 1e3, 1e9),
            ("thickness_m", 1e-5, 0.1),
            ("radius_major_m", 5e-5, 10),
            ("radius_minor_m", 5e-5, 10),
        ):
            radii = {"radius_major_m": 10.0, "radius_minor_m": 5e-5}
            for usual in (low, high):
                self.assertEqual(self.warned(**{**radii, name: usual})[1], [], name)
            if name == "radius_minor_m":
                radii["radius_major_m"] = 20.0
            for odd in (0.99 * low, 1.01 * high):
                if name == "radius_major_m" and odd < low:
                    radii["radius_minor_m"] = odd
                (warning,) = self.warned(**{**radii, name: odd})[1]
                self.assertIn(f"{name} = {odd:g}", str(warning.message))

    def test_the_first_one_of_an_array_is_named_once(self):
        for function in (softfinger.error_bound, softfinger.select):
            _, (warning,) = self.warned(function, youngs_modulus_Pa=[3e5, 300, 400])
            self.assertIn("youngs_modulus_Pa = 300 (usual: 1 kPa to 1 GPa)", str(warning.message))

    def test_a_rigid_object_and_a_flat_finger_are_usual(self):
        zeros = dict(object_thickness_m=0, object_youngs_modulus_Pa=0.0, finger_xx_per_m=[0.0])
        self.assertEqual(self.warned(**zeros)[1], [])


class TheRecommendedModel(unittest.TestCase):
    def test_it_answers_where_none_is_named_and_is_named_in_the_result(self):
        self.assertEqual(softfinger.predict(**PAD).model, softfinger.error_bound(**PAD).model)
        hollow = {**PAD, "finger_xx_per_m": [10.0, -10.0], "finger_yy_per_m": 100.0}
        contact = softfinger.predict(**hollow)
        self.assertEqual(contact.model.tolist(), ["fingertip_layer", "bonded_layer"])
        for i, model in enumerate(contact.model):
            alone = {k: v[i] if isinstance(v, list) else v for k, v in hollow.items()}
            single = softfinger.predict(**alone)
            self.assertEqual(single, softfinger.predict(**alone, model=model))
            self.assertEqual(contact.max_torque_Nm[i], single.max_torque_Nm)
            self.assertEqual(
                softfinger.error_bound(**hollow).bound.area[i],
                softfinger.error_bound(**alone, model=model).bound.area,
            )
            self.assertEqual(
                softfinger.predict_with_gradient(**hollow).d_a_m.thickness_m[i],
                softfinger.predict_with_gradient(**alone, model=model).d_a_m.thickness_m,
            )


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
        self.assertRegex(text, r"^Prediction\(model='\w+_layer', has_answer=True, a_m=0\.00")

    def test_their_text_is_a_few_lines(self):
        for arguments in (PAD, random_contacts(5), random_contacts(500)):
            for function, lines in (
                (softfinger.predict, 10),
                (softfinger.error_bound, 8),
                (softfinger.select, 2),
                (softfinger.predict_with_gradient, 10),
            ):
                text = repr(function(**arguments)).split("\n")
                self.assertLessEqual(len(text), lines, text)
                self.assertLessEqual(max(map(len, text)), 100, text)
        self.assertRegex(repr(softfinger.select(**PAD)), r"^Choice\(model='\w+', bound=0\.\d+\)$")

    def test_no_answer_of_an_array_is_masked_and_nan_for_who_takes_the_mask_off(self):
        stiff = {**PAD, "poisson_ratio": [0.4, 0.5]}
        contact = softfinger.predict(**stiff, model="winkler")
        self.assertEqual(contact.has_answer.tolist(), [True, False])
        for field in dataclasses.fields(contact):
            values = getattr(contact, field.name)
            as_asked = field.name in (*stiff, "pressing", "shear_strength_Pa")
            if as_asked or not isinstance(values, numpy.ndarray) or values.dtype == bool:
                continue
            self.assertEqual(values.mask.tolist(), [False, True], field.name)
            self.assertTrue(numpy.isnan(numpy.asarray(values)[1]), field.name)
            self.assertEqual(values.sum(), values[0])
        used = contact.friction_ellipsoid().utilisation([0.5, 0, 0])
        self.assertEqual(used.mask.tolist(), [False, True])
        self.assertNotIsInstance(
            softfinger.predict(**stiff, model="hertz").a_m, numpy.ma.MaskedArray
        )

    def test_no_answer_of_one_contact_is_raised_and_says_why(self):
        stiff = {**PAD, "poisson_ratio": 0.5}
        functions = {
            "predict": softfinger.predict,
            "pressure_Pa": lambda **numbers: softfinger.pressure_Pa(**numbers, x_m=0, y_m=0),
            "eccentricity_law": softfinger.eccentricity_law,
            "predict_with_gradient": softfinger.predict_with_gradient,
        }
        for name, function in functions.items():
            with self.assertRaisesRegex(
                softfinger.NoAnswer, "'winkler' has no answer: at nu = 1/2", msg=name
            ) as caught:
                function(**stiff, model="winkler")
            self.assertIsInstance(caught.exception, ValueError)
            self.assertEqual(pickle.loads(pickle.dumps(caught.exception)).value, "winkler")
        failing = softfinger.checks(**{**PAD, "poisson_ratio": 0.5}, model="winkler")
        self.assertTrue(any(not check.holds and check.message for check in failing))

    def test_what_a_double_cannot_hold_is_no_answer(self):
        huge = {**PAD, "normal_force_N": 1e200, "friction_coefficient": [0.5, 1e200]}
        for model in ("hertz", "winkler"):
            contact = softfinger.predict(**huge, model=model)
            self.assertEqual(contact.has_answer.tolist(), [True, False])
            for values in (contact.max_force_N, contact.max_torque_Nm, contact.a_m):
                self.assertEqual(values.mask.tolist(), [False, True])
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
        names = [number.name for number in _contacts.NUMBERS]
        defaults = {n.name: n.default for n in _contacts.NUMBERS}
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
