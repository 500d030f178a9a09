"""Derivatives against complex steps of closed forms, and against high-order differences."""

import dataclasses
import unittest

import numpy

import softfinger
from samples import FAST_MODELS, PAD, random_contacts

VARIABLES = [field.name for field in dataclasses.fields(softfinger.Derivatives)]


def winkler(P, E, nu, h, R1, R2, mu):
    """The closed form, as in analytic/README.md; complex numbers pass."""
    M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    d = numpy.sqrt(P * h / (M * numpy.pi * numpy.sqrt(R1 * R2)))
    return {
        "indentation_m": d,
        "a_m": numpy.sqrt(2 * d * R1),
        "b_m": numpy.sqrt(2 * d * R2),
        "peak_pressure_Pa": M * d / h,
        "area_m2": 2 * numpy.pi * d * numpy.sqrt(R1 * R2),
    }


def hertz_circle(P, E, nu, h, R1, R2, mu):
    """Of a sphere, with R1 = R2 = R varied together."""
    a = (3 * P * R1 * (1 - nu**2) / (4 * E)) ** (1 / 3)
    return {
        "indentation_m": a**2 / R1,
        "peak_pressure_Pa": 3 * P / (2 * numpy.pi * a**2),
        "area_m2": numpy.pi * a**2,
        "torque_arm_exact_m": 3 * numpy.pi / 16 * a,
        "max_torque_Nm": mu * P * 3 * numpy.pi / 16 * a,
    }


def complex_steps(function, values):
    """Exact derivatives: no difference is taken."""
    step = 1e-30
    for k in range(len(values)):
        moved = [complex(value, step * value * (i == k)) for i, value in enumerate(values)]
        yield {name: number.imag / (step * values[k]) for name, number in function(*moved).items()}


class Gradient(unittest.TestCase):
    def test_winkler_equals_complex_steps_of_its_closed_form(self):
        values = list(PAD.values())
        contact = softfinger.predict_with_gradient(**PAD, model="winkler")
        for variable, expected in zip(PAD, complex_steps(winkler, values)):
            for number, derivative in expected.items():
                found = getattr(getattr(contact, "d_" + number), variable)
                # The product of a dozen roundings.
                self.assertAlmostEqual(
                    found, derivative, delta=1e-14 * max(abs(derivative), 1e-300) * 10
                )

    def test_hertz_equals_complex_steps_for_a_sphere(self):
        ball = {**PAD, "radius_major_m": 0.01, "radius_minor_m": 0.01, "thickness_m": 1.0}
        contact = softfinger.predict_with_gradient(**ball, model="hertz")
        for variable, expected in zip(ball, complex_steps(hertz_circle, list(ball.values()))):
            for number, derivative in expected.items():
                by = getattr(contact, "d_" + number)
                found = getattr(by, variable)
                if variable == "radius_major_m":  # both radii at once
                    found = found + by.radius_minor_m
                elif variable == "radius_minor_m":
                    continue
                self.assertAlmostEqual(found, derivative, delta=1e-12 * abs(derivative) + 1e-300)

    def test_all_models_equal_differences_of_sixth_order(self):
        contacts = random_contacts(40)
        contacts["poisson_ratio"] = 0.05 + 0.85 * contacts["poisson_ratio"]  # room for the steps
        contacts["radius_major_m"] *= 1.1
        # Truncation falls with the sixth power of the step: 4e-7 at 2e-3, 9e-11 here. Below half of
        # this step rounding, 1e-16 over the step, is larger.
        step = 5e-4
        weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
        worst = 0
        for model in FAST_MODELS:
            extra = dict(power_law_coefficient=2e-3) if model == "power_law" else {}
            exact = softfinger.predict_with_gradient(**contacts, **extra, model=model)
            for variable in VARIABLES:
                if variable == "finger_xy_per_m":
                    continue
                x = contacts[variable]
                h = step * x
                slope = {}
                for k, weight in weights.items():
                    ahead, behind = (
                        softfinger.predict(
                            **{**contacts, variable: x + s * k * h}, **extra, model=model
                        )
                        for s in (1, -1)
                    )
                    for number in (
                        "a_m",
                        "b_m",
                        "indentation_m",
                        "peak_pressure_Pa",
                        "torque_arm_exact_m",
                        "max_torque_Nm",
                    ):
                        part = weight * (getattr(ahead, number) - getattr(behind, number)) / h
                        slope[number] = slope.get(number, 0) + part
                for number, expected in slope.items():
                    found = getattr(getattr(exact, "d_" + number), variable)
                    scale = abs(getattr(exact.prediction, number) / x)
                    known = exact.known & (scale > 0)
                    error = numpy.max(abs(found - expected)[known] / scale[known], initial=0)
                    worst = max(worst, error)
                    self.assertLess(error, 1e-9, f"{model}: d {number} / d {variable}")
        print(f"worst of the differences, relative: {worst:.1e}")

    def test_stiffness_is_the_inverse_of_the_indentation_per_load(self):
        contact = softfinger.predict_with_gradient(**PAD)
        self.assertEqual(
            contact.normal_stiffness_N_per_m, 1 / contact.d_indentation_m.normal_force_N
        )

    def test_what_has_no_derivatives_is_masked_or_raised(self):
        """An elliptic contact of two layers is answered, and has no derivatives."""
        layers = {**PAD, "object_youngs_modulus_Pa": 3e5, "object_poisson_ratio": 0.45}
        contact = softfinger.predict_with_gradient(**layers, object_thickness_m=[0.0, 2e-3])
        self.assertEqual(contact.known.tolist(), [True, False])
        self.assertEqual(contact.prediction.has_answer.tolist(), [True, True])
        for values in (contact.normal_stiffness_N_per_m, contact.d_a_m.thickness_m):
            self.assertEqual(values.mask.tolist(), [False, True])
        with self.assertRaisesRegex(softfinger.NoAnswer, "no derivatives"):
            softfinger.predict_with_gradient(**layers, object_thickness_m=2e-3)


if __name__ == "__main__":
    unittest.main()
