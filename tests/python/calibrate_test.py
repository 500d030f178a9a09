"""Calibrations, with the numbers of the program."""

import json
import os
import pathlib
import pickle
import subprocess
import sys
import threading
import time
import types
import unittest
import unittest.mock

import numpy

import softfinger
from samples import needs_program
from softfinger import _calibrate, _core

MEASUREMENTS = pathlib.Path(os.environ["SOFTFINGER_SOURCE"], "comparisons", "measurements")

#: Of the built-in case silicone_pad_2mm.
FINGER = dict(
    radius_major_m=20e-3,
    radius_minor_m=12e-3,
    youngs_modulus_Pa=500e3,
    thickness_m=2e-3,
    poisson_ratio=0.49,
    friction_coefficient=0.8,
)


def inked_fingertip():
    """The built-in measurements as arguments."""
    lines = (MEASUREMENTS / "inked_fingertip.csv").read_text(encoding="utf-8").splitlines()
    header, *rows = [line.split(",") for line in lines if line and not line.startswith("#")]
    columns = numpy.array([[float(cell) if cell else numpy.nan for cell in row] for row in rows]).T
    names = {"a_mm": "a_m", "b_mm": "b_m", "indentation_mm": "indentation_m"}
    names.update(load_N="load_N", max_torque_mNm="max_torque_Nm")
    scales = {name: 1e-3 if name != "load_N" else 1.0 for name in names}
    return {names[n]: column * scales[n] for n, column in zip(header, columns)}


def told(*arguments):
    """What `softfinger calibrate --json` says of them."""
    command = [os.environ["SOFTFINGER_PROGRAM"], "calibrate", "inked_fingertip.csv"]
    run = subprocess.run(
        [*command, "silicone_pad_2mm", *arguments, "--json"],
        capture_output=True,
        check=True,
    )
    return json.loads(run.stdout)


class Calibrate(unittest.TestCase):
    def assert_same(self, found, document):
        """The same library and the same order: the same bits, which JSON keeps."""
        self.assertEqual(found.model, document["model"])
        self.assertEqual(found.shear_law, document["shear_law"])
        self.assertEqual(set(found.parameters), set(document["parameters"]))
        for name, one in document["parameters"].items():
            estimate = found.parameters[name]
            self.assertEqual(estimate.value, one["value"])
            self.assertEqual(estimate.std, numpy.inf if one["std"] is None else one["std"])
            self.assertEqual(list(estimate.interval95), one["interval95"])
            self.assertEqual(list(estimate.interval_open), one["interval_open"])
            self.assertEqual(estimate.determined, one["determined"])
        self.assertEqual(found.fixed, document["fixed"])
        names = list(found.parameters)
        if document["covariance"] is None:
            self.assertIsNone(found.covariance)
        else:
            rows = [[document["covariance"][i][k] for k in names] for i in names]
            self.assertEqual(found.covariance.tolist(), rows)
        # The program makes sentences of them.
        self.assertEqual(
            [sentence.lower() + "." for sentence in found.cannot_tell],
            [sentence.lower() for sentence in document["cannot_tell"]],
        )
        for ours, theirs, key in (
            (found.models, document["models"], "model"),
            (found.shear_laws, document["shear_laws"], "shear_law"),
        ):
            self.assertEqual([one.name for one in ours], [one[key] for one in theirs])
            for one, other in zip(ours, theirs):
                self.assertEqual(one.parameters, other["parameters"])
                for name in ("aic", "scatter", "held_out_error"):
                    self.assertEqual(getattr(one, name), other[name])
        self.assertEqual(
            [(one.load_N, one.predicted, one.deviation) for one in found.outliers],
            [(one["load_N"], one["predicted"], one["sigma"]) for one in document["outliers"]],
        )
        goodness = document["goodness"]
        for name in ("probability", "error_factor", "sum_of_squares", "degrees_of_freedom"):
            self.assertEqual(getattr(found.goodness, name), goodness[name])
        self.assertEqual(list(found.goodness.scatter.values()), list(goodness["scatter"].values()))
        growth = document["growth_exponent"]
        self.assertEqual(found.growth_exponent, (growth["value"], growth["std"]))
        following = document["next_measurement"]
        if following is None:
            self.assertIsNone(found.next_measurement)
        else:
            for name in ("load_N", "relative_std", "parameter"):
                self.assertEqual(getattr(found.next_measurement, name), following[name])
            self.assertTrue(found.next_measurement.quantity.startswith(following["quantity"]))
            for name in ("std_now", "std_then"):
                theirs = numpy.inf if following[name] is None else following[name]
                self.assertEqual(getattr(found.next_measurement, name), theirs)
        for residual in document["residuals"]:
            (name,) = [n for n in found.measured if n.rsplit("_", 1)[0] == residual["quantity"]]
            (row,) = numpy.flatnonzero(found.load_N == residual["load_N"])
            self.assertEqual(found.predicted[name][row], residual["predicted"])
            self.assertEqual(found.deviation[name][row], residual["sigma"])
            self.assertEqual(found.std[name][row], residual["std"])

    @needs_program
    def test_the_numbers_are_those_of_the_program(self):
        self.assert_same(softfinger.calibrate(**inked_fingertip(), **FINGER), told())

    @needs_program
    def test_so_are_those_of_other_questions(self):
        found = softfinger.calibrate(
            **inked_fingertip(),
            **FINGER,
            fixed={"thickness_m": 2e-3},
            fit=["youngs_modulus", "poisson_ratio", "friction_coefficient"],
        )
        fit = "youngs_modulus,poisson_ratio,friction_coefficient"
        self.assert_same(found, told("--fix", "thickness_m=0.002", "--fit", fit))
        for model in ("hertz", "winkler", "bonded_layer"):
            found = softfinger.calibrate(**inked_fingertip(), **FINGER, model=model)
            self.assert_same(found, told("--model", model))

    @needs_program
    def test_so_are_those_of_another_shear_law(self):
        found = softfinger.calibrate(
            **inked_fingertip(), **FINGER, shear_law="limited", shear_strength_Pa=40e3
        )
        law = ("--set", 'contact.shear_law="limited"', "--set", "contact.shear_strength_kPa=40")
        self.assert_same(found, told(*law))

    def test_exact_measurements_give_the_finger_back(self):
        loads_N = numpy.array([[3.0, 0.3], [1.0, 0.1]])  # in any order and shape
        pad = {**FINGER, "youngs_modulus_Pa": 350e3, "thickness_m": 2.5e-3}
        for law in (
            {},
            {"shear_law": "limited", "shear_strength_Pa": 30e3},
            {"shear_law": "adhesive_shear", "shear_strength_Pa": 10e3},
        ):
            truth = softfinger.predict(**pad, **law, normal_force_N=loads_N)
            found = softfinger.calibrate(
                load_N=loads_N,
                a_m=truth.a_m,
                a_m_std=0.01 * truth.a_m,
                indentation_m=truth.indentation_m,
                indentation_m_std=0.01 * truth.indentation_m,
                max_torque_Nm=truth.max_torque_Nm,
                max_torque_Nm_std=0.01 * truth.max_torque_Nm,
                **FINGER,
                **({**law, "shear_strength_Pa": 20e3} if law else {}),
            )
            for argument, name in (
                ("youngs_modulus_Pa", "youngs_modulus"),
                ("thickness_m", "thickness"),
            ):
                # A relative error of 1 % puts the mean logarithm by half its square below the
                # truth's, which the fit corrects for.
                self.assertAlmostEqual(found.parameters[name].value / pad[argument], 1, delta=1e-3)
            again = softfinger.predict(**found.contact, normal_force_N=loads_N)
            for name, values in found.predicted.items():
                numpy.testing.assert_allclose(getattr(again, name), values, rtol=1e-9)

    def test_the_radius_can_be_found_and_is_passed_on(self):
        loads_N = numpy.geomspace(0.2, 5, 6)
        bodies = dict(finger_xx_per_m=20.0, finger_yy_per_m=40.0)
        truth = softfinger.predict(**FINGER, **bodies, normal_force_N=loads_N)
        start = dict(radius_major_m=22e-3, radius_minor_m=13.2e-3)
        start.update({name: value / 1.1 for name, value in bodies.items()})
        found = softfinger.calibrate(
            **{**FINGER, **start}, load_N=loads_N, a_m=truth.a_m, b_m=truth.b_m, fit="radius"
        )
        self.assertAlmostEqual(found.contact["radius_major_m"] / 20e-3, 1, delta=1e-6)
        self.assertAlmostEqual(found.contact["finger_yy_per_m"] / 40.0, 1, delta=1e-6)

    def test_friction_that_nothing_was_said_of_stays_open(self):
        widths = {k: v for k, v in inked_fingertip().items() if k in ("load_N", "a_m", "b_m")}
        finger = {k: v for k, v in FINGER.items() if k != "friction_coefficient"}
        found = softfinger.calibrate(**widths, **finger)
        self.assertNotIn("friction_coefficient", found.fixed)
        self.assertNotIn("friction_coefficient", found.contact)
        self.assertEqual(found.shear_laws, ())

    def test_curves_pass_through_what_is_predicted_and_have_it_in_their_band(self):
        found = softfinger.calibrate(**inked_fingertip(), **FINGER)
        for name, curve in found.curves.items():
            at = ~numpy.ma.getmaskarray(found.measured[name])
            drawn = numpy.interp(
                numpy.log(found.load_N[at]), numpy.log(curve.load_N), numpy.log(curve.value)
            )
            # Powers of the load, straight between points that are 12 % apart.
            numpy.testing.assert_allclose(numpy.exp(drawn), found.predicted[name][at], rtol=1e-3)
            self.assertTrue((curve.low < curve.value).all() and (curve.value < curve.high).all())

    def test_what_was_not_measured_is_masked_and_may_be_given_so(self):
        measured = inked_fingertip()
        masked = {name: numpy.ma.masked_invalid(values) for name, values in measured.items()}
        found = softfinger.calibrate(**measured, **FINGER)
        self.assertEqual(softfinger.calibrate(**masked, **FINGER), found)
        missing = numpy.isnan(measured["max_torque_Nm"])
        self.assertTrue(missing.any())
        for arrays in (found.measured, found.std, found.predicted, found.deviation):
            torque = arrays["max_torque_Nm"]
            self.assertEqual(numpy.ma.getmaskarray(torque).tolist(), missing.tolist())

    def test_what_too_few_data_leave_unknown_is_none(self):
        widths = {k: v[:2] for k, v in inked_fingertip().items() if k in ("load_N", "a_m", "b_m")}
        found = softfinger.calibrate(**widths, **FINGER, fit=["youngs_modulus"])
        self.assertIn(None, [model.held_out_error for model in found.models])

    def test_what_cannot_be_used_is_refused_by_name(self):
        good = {**inked_fingertip(), **FINGER}
        one = numpy.where(numpy.arange(8) == 3, -1.0, good["a_m"])
        for wrong, argument in (
            (dict(a_m=one), r"a_m\[3\]"),
            (dict(load_N=0), "load_N"),
            (dict(b_m_std=0.0), "b_m_std"),
            (dict(area_m2_std=1e-6), "area_m2_std"),
            (dict(b_m=[1e-3, 2e-3]), "shapes"),
            (dict(youngs_modulus_Pa=[1e5, 2e5]), "youngs_modulus_Pa"),
            (dict(thickness_m=0), "thickness_m"),
            (dict(thickness_m=5.0), "thickness_m"),
            (dict(poisson_ratio=0.6), "poisson_ratio"),
            (dict(radius_minor_m=30e-3), "radius_minor_m"),
            (dict(finger_xx_per_m=numpy.nan), "finger_xx_per_m"),
            (dict(fit=["stiffness"]), "fit"),
            (dict(fit=["thickness", "thickness"]), "fit"),
            (dict(fit=[]), "fit"),
            (dict(fit=3), "fit"),
            (dict(fit=[["thickness"]]), "fit"),
            (dict(fixed=["thickness_m"]), "fixed"),
            (dict(fit="shear_strength"), "fit"),
            (dict(fixed={"thickness_mm": 2}), "fixed"),
            (dict(fixed={"thickness_m": 2}), r"fixed\['thickness_m'\]"),
            (dict(fixed={"thickness_m": 2e-3}, fit=["thickness"]), "fit"),
            (dict(fixed={"shear_strength_Pa": 1e4}), "fixed"),
            (dict(shear_strength_Pa=1e4), "shear_strength_Pa"),
            (dict(model="layer_fft"), "model"),
            (dict(shear_law="viscous"), "shear_law"),
            (dict(winkler_modulus="bulk"), "winkler_modulus"),
        ):
            with self.subTest(wrong), self.assertRaisesRegex(
                softfinger.InputError, "^calibrate: " + argument
            ):
                softfinger.calibrate(**{**good, **wrong})
        nothing = {k: v for k, v in good.items() if k in FINGER or k == "load_N"}
        with self.assertRaisesRegex(softfinger.InputError, "measurements"):
            softfinger.calibrate(**nothing)
        with self.assertRaisesRegex(softfinger.InputError, "number of measured values"):
            softfinger.calibrate(**{**nothing, "load_N": [1.0, 2.0]}, a_m=[1e-3, numpy.nan])

    def test_a_model_without_an_answer_is_refused(self):
        widths = {k: v for k, v in inked_fingertip().items() if k in ("load_N", "b_m")}
        # An incompressible layer has no oedometric modulus.
        with self.assertRaisesRegex(softfinger.InputError, "^calibration: model = 'winkler'"):
            softfinger.calibrate(**widths, **{**FINGER, "poisson_ratio": 0.5}, model="winkler")

    def test_data_that_no_model_explains_are_refused_with_the_worst(self):
        wild = {**inked_fingertip(), "a_m": [1e-3, 8e-3, 1e-3, 9e-3, 1e-3, 7e-3, 1e-3, 8e-3]}
        with self.assertRaisesRegex(softfinger.InputError, r"^calibrate: no model .* sigma"):
            softfinger.calibrate(**wild, **FINGER)

    def test_it_survives_pickling_and_prints_shortly(self):
        found = softfinger.calibrate(**inked_fingertip(), **FINGER)
        self.assertEqual(pickle.loads(pickle.dumps(found)), found)
        self.assertNotEqual(
            softfinger.calibrate(**inked_fingertip(), **FINGER, fit="thickness"), found
        )
        self.assertTrue(repr(found).startswith("Calibration(model='fingertip_layer'"))
        self.assertNotIn("array([[[", repr(found))

    def test_threads_may_calibrate_at_once(self):
        results = [None] * 4

        def work(i):
            results[i] = softfinger.calibrate(**inked_fingertip(), **FINGER)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(len(results))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            self.assertEqual(result, results[0])

    def test_other_threads_run_meanwhile(self):
        """With an endless switch interval only a call that lets go of the lock lets others run."""
        state = []

        def calibrate(*arguments):
            state.append("begun")
            found = _core.calibrate(*arguments)
            state.append("done")
            return found

        arguments = {**inked_fingertip(), **FINGER}
        worker = threading.Thread(target=softfinger.calibrate, kwargs=arguments)
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1e6)
        try:
            with unittest.mock.patch.object(
                _calibrate, "_core", types.SimpleNamespace(calibrate=calibrate)
            ):
                worker.start()
                seen = set()
                while worker.is_alive():
                    seen.add(tuple(state))
                    time.sleep(0)
                worker.join()
        finally:
            sys.setswitchinterval(interval)
        self.assertEqual(state, ["begun", "done"])
        self.assertIn(("begun",), seen)


if __name__ == "__main__":
    unittest.main()
