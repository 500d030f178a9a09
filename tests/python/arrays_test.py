"""softfinger.arrays against the compiled part, on numpy and on torch."""

import dataclasses
import unittest

import numpy

import softfinger
from samples import PAD, random_contacts
from softfinger import arrays

try:
    import torch
except ImportError:
    torch = None

needs_torch = unittest.skipUnless(torch, "no torch (Debian: python3-torch)")
MODELS = ("fingertip_layer", "bonded_layer")
#: The module promises these. The compiled part has its own exp and log, each to two units in the
#: last place; numbers whose logarithm is 40 then differ by 40 times as much, which is 2e-14.
VALUES, DERIVATIVES = 1e-12, 1e-10
FLAT_PAD = dict(
    youngs_modulus_Pa=8e5, poisson_ratio=0.49, thickness_m=3e-3, friction_coefficient=0.7
)


def usual_contacts(count, seed=2):
    """All that `predict` takes without a warning, with R'/R'' to 10,000."""
    random = numpy.random.default_rng(seed)

    def between(low, high):
        return numpy.exp(random.uniform(numpy.log(low), numpy.log(high), count))

    minor_m = between(5e-5, 1.0)
    major_m = numpy.minimum(10.0, minor_m * between(1, 1e4))
    return dict(
        normal_force_N=between(1e-4, 1e4),
        youngs_modulus_Pa=between(1e3, 1e9),
        poisson_ratio=random.uniform(0, 0.5, count),
        thickness_m=between(1e-5, 0.1),
        radius_major_m=major_m,
        radius_minor_m=minor_m,
        friction_coefficient=between(0.01, 10),
        finger_xx_per_m=random.uniform(-1, 1, count) / major_m,
        finger_yy_per_m=random.uniform(-1, 1, count) / minor_m,
        finger_xy_per_m=random.uniform(-0.3, 0.3, count) / major_m,
    )


def contacts_at_borders():
    """Spheres, nu of 0 and 1/2, and the longest ellipse of the table."""
    return {**PAD, "finger_xx_per_m": 20.0, "finger_yy_per_m": 30.0} | dict(
        radius_major_m=numpy.array([20e-3, 5e-3, 5e-3, 5e-3, 100 * 5e-3, 5e-3]),
        poisson_ratio=numpy.array([0.0, 0.5, 0.45, 0.0, 0.5, 0.5]),
    )


def of_torch(contacts):
    return {name: torch.asarray(values, dtype=torch.float64) for name, values in contacts.items()}


def predicted(model, contacts, **options):
    """The model's answer, with the arguments that it takes."""
    if model == "bonded_layer":
        contacts = {name: x for name, x in contacts.items() if not name.startswith("finger_")}
    return getattr(arrays, model)(**contacts, **options)


def largest_error(found, expected):
    """Relative; both have an answer at the same places."""
    found, expected = numpy.asarray(found), numpy.ma.filled(expected, numpy.nan)
    numpy.testing.assert_array_equal(numpy.isnan(found), numpy.isnan(expected))
    known = numpy.broadcast_to(~numpy.isnan(expected) & (expected != 0), found.shape)
    return numpy.max(numpy.abs(found / numpy.where(known, expected, 1) - 1)[known], initial=0)


class Values(unittest.TestCase):
    def compare(self, contacts, taken):
        for model in MODELS:
            expected = softfinger.predict_with_gradient(**contacts, model=model)
            found = predicted(model, taken, with_stiffness=True)
            worst = largest_error(found.normal_stiffness_N_per_m, expected.normal_stiffness_N_per_m)
            self.assertLess(worst, DERIVATIVES)
            for name in arrays.Contact._fields[:-1]:
                error = largest_error(getattr(found, name), getattr(expected.prediction, name))
                self.assertLess(error, VALUES, f"{model}: {name}")
                worst = max(worst, error)
            stuck = arrays.stuck_stiffness(
                a_m=found.a_m,
                b_m=found.b_m,
                **{n: taken[n] for n in ("thickness_m", "youngs_modulus_Pa", "poisson_ratio")},
            )
            for name in arrays.StuckStiffness._fields:
                whole = name.replace("torsional", "torsional_stiffness").replace(
                    "tangential", "tangential_stiffness"
                )
                error = largest_error(getattr(stuck, name), getattr(expected, whole))
                self.assertLess(error, VALUES, f"{model}: {name}")
            print(f"{model}: worst of all numbers, relative: {worst:.1e}")

    def test_numpy_equals_the_compiled_part(self):
        for contacts in (usual_contacts(100_000), random_contacts(20_000), contacts_at_borders()):
            self.compare(contacts, contacts)

    @needs_torch
    def test_torch_equals_the_compiled_part(self):
        for contacts in (usual_contacts(100_000), random_contacts(20_000), contacts_at_borders()):
            self.compare(contacts, of_torch(contacts))

    def test_exact_spheres(self):
        contacts = random_contacts(1000)
        found = arrays.fingertip_layer(**contacts, is_object_spherical=True)
        expected = softfinger.predict(**contacts, is_object_spherical=True, model="fingertip_layer")
        self.assertLess(largest_error(found.a_m, expected.a_m), VALUES)

    def test_bounds(self):
        """A bound is the difference of a ratio from 1, whose round-off it has."""
        for contacts in (usual_contacts(20_000), random_contacts(20_000)):
            for model in MODELS:
                found = arrays.error_bound(model, **contacts)
                bound = softfinger.error_bound(**contacts, model=model).bound
                for name in arrays.Bounds._fields:
                    numpy.testing.assert_allclose(
                        getattr(found, name), getattr(bound, name), rtol=VALUES, atol=VALUES
                    )

    def test_pads(self):
        random = numpy.random.default_rng(3)
        count = 5000
        numbers = dict(
            normal_force_N=numpy.exp(random.uniform(-3, 6, count)),
            youngs_modulus_Pa=numpy.exp(random.uniform(9, 16, count)),
            poisson_ratio=numpy.append(random.uniform(0, 0.5, count - 2), [0, 0.5]),
            thickness_m=numpy.exp(random.uniform(-9, -2, count)),
            friction_coefficient=random.uniform(0, 2, count),
        )
        for pad in (
            softfinger.FlatPad.disc(20e-3),
            softfinger.FlatPad.rectangle(22e-3, 37.5e-3),
            softfinger.FlatPad.polygon([[0, 0], [30e-3, 0], [5e-3, 20e-3]]),
        ):
            for pressing in ("stuck", "frictionless"):
                found = arrays.pad_layer(pad, **numbers, pressing=pressing)
                expected = pad.predict(**numbers, pressing=pressing)
                for name in arrays.Pad._fields:
                    numpy.testing.assert_allclose(
                        getattr(found, name), getattr(expected, name), rtol=VALUES
                    )

    def test_a_single_precision_array_is_answered_in_single_precision(self):
        contacts = random_contacts(1000)
        single = {name: values.astype(numpy.float32) for name, values in contacts.items()}
        found = arrays.fingertip_layer(**single)
        self.assertEqual(found.a_m.dtype, numpy.float32)
        expected = softfinger.predict(**contacts, model="fingertip_layer")
        # Logarithms to 10 lose a digit of seven.
        self.assertLess(largest_error(found.max_torque_Nm, expected.max_torque_Nm), 1e-4)

    def test_shapes_broadcast(self):
        load_N, thickness_m = numpy.array([1.0, 2.0, 3.0]), numpy.array([[1e-3], [2e-3]])
        contacts = {**PAD, "normal_force_N": load_N, "thickness_m": thickness_m}
        found = arrays.fingertip_layer(**contacts)
        self.assertEqual({x.shape for x in found if x is not None}, {(2, 3)})
        expected = softfinger.predict(**contacts, model="fingertip_layer")
        self.assertLess(largest_error(found.a_m, expected.a_m), VALUES)
        self.assertEqual(arrays.fingertip_layer(**PAD).a_m.shape, ())


@needs_torch
class Gradients(unittest.TestCase):
    def test_autograd_equals_predict_with_gradient(self):
        variables = {field.name for field in dataclasses.fields(softfinger.Derivatives)}
        self.assertEqual(variables, set(usual_contacts(1)))
        for contacts in (
            usual_contacts(20_000, 5),
            random_contacts(20_000, 6),
            contacts_at_borders(),
        ):
            shape = numpy.broadcast_shapes(*(numpy.shape(x) for x in contacts.values()))
            contacts = {n: numpy.broadcast_to(x, shape).astype(float) for n, x in contacts.items()}
            for model in MODELS:
                exact = softfinger.predict_with_gradient(**contacts, model=model)
                taken = of_torch({n: x.copy() for n, x in contacts.items()})
                for tensor in taken.values():
                    tensor.requires_grad_(True)
                found = predicted(model, taken)
                worst = 0
                for number in ("a_m", "b_m", "indentation_m", "peak_pressure_Pa", "max_torque_Nm"):
                    value = getattr(found, number)
                    slopes = torch.autograd.grad(
                        value.sum(), list(taken.values()), retain_graph=True, allow_unused=True
                    )
                    for variable, slope in zip(taken, slopes):
                        expected = getattr(getattr(exact, "d_" + number), variable)
                        slope = numpy.zeros(shape) if slope is None else slope.numpy()
                        # A derivative can vanish. Its terms have the size of the number over the
                        # variable; curvature is measured against the layer.
                        x = contacts[variable]
                        if variable.startswith("finger_"):
                            x = 1 / contacts["thickness_m"]
                        size = numpy.abs(value.detach().numpy() / numpy.where(x == 0, 1, x))
                        error = numpy.max(
                            numpy.abs(slope - expected) / numpy.maximum(numpy.abs(expected), size),
                            initial=0,
                        )
                        self.assertLess(error, DERIVATIVES, f"{model}: d {number} / d {variable}")
                        worst = max(worst, error)
                print(f"{model}: worst of all derivatives: {worst:.1e}")

    def test_parameters_of_a_network_are_tensors(self):
        thickness_m = torch.nn.Parameter(torch.tensor(2e-3, dtype=torch.float64))
        torque = arrays.fingertip_layer(**{**PAD, "thickness_m": thickness_m}).max_torque_Nm
        torque.backward()
        one = softfinger.predict_with_gradient(**PAD, model="fingertip_layer")
        self.assertLess(
            largest_error(thickness_m.grad, one.d_max_torque_Nm.thickness_m), DERIVATIVES
        )

    def test_a_bad_contact_leaves_the_derivatives_of_the_others_alone(self):
        thickness_m = torch.tensor([2e-3, numpy.nan, -1.0, 2e-3], dtype=torch.float64)
        shared = torch.tensor(3e5, dtype=torch.float64, requires_grad=True)
        contacts = {**PAD, "youngs_modulus_Pa": shared, "thickness_m": thickness_m}
        torque = arrays.fingertip_layer(**contacts).max_torque_Nm
        self.assertEqual(torch.isnan(torque).tolist(), [False, True, True, False])
        (slope,) = torch.autograd.grad(torque[torch.isfinite(torque)].sum(), shared)
        one = softfinger.predict_with_gradient(**PAD, model="fingertip_layer")
        self.assertLess(
            largest_error(slope, 2 * one.d_max_torque_Nm.youngs_modulus_Pa), DERIVATIVES
        )

    def test_pads_and_the_ellipsoid_have_derivatives(self):
        pad = softfinger.FlatPad.rectangle(22e-3, 37.5e-3)
        h = torch.tensor(3e-3, dtype=torch.float64, requires_grad=True)

        def torque_at(h):
            numbers = {**FLAT_PAD, "thickness_m": h}
            return arrays.pad_layer(pad, **numbers, normal_force_N=20.0)

        answer = torque_at(h)
        (slope,) = torch.autograd.grad(answer.max_torque_Nm, h)
        # Central differences of sixth order: truncation and round-off are below 1e-11.
        step, expected = 5e-3, 0
        for k, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
            for side in (1, -1):
                changed = {**FLAT_PAD, "thickness_m": 3e-3 * (1 + side * k * step)}
                torque = pad.predict(**changed, normal_force_N=20.0).max_torque_Nm
                expected += side * weight * torque / (step * 3e-3)
        self.assertLess(largest_error(slope, expected), DERIVATIVES)
        force = torch.zeros(3, dtype=torch.float64, requires_grad=True)
        used = arrays.utilisation(
            answer.max_force_N.detach(), answer.eccentricity_m.detach(), *force
        )
        (slope,) = torch.autograd.grad(used, force)
        self.assertEqual(slope.tolist(), [0, 0, 0])


class Inputs(unittest.TestCase):
    def test_what_is_out_of_range_is_no_number(self):
        for name, value in (
            ("normal_force_N", 0.0),
            ("youngs_modulus_Pa", numpy.inf),
            ("poisson_ratio", 0.51),
            ("thickness_m", -1e-3),
            ("radius_major_m", 4e-3),  # below R''
            ("radius_major_m", 5e-3 * 22_100),  # beyond the table
            ("radius_minor_m", numpy.nan),
            ("friction_coefficient", -0.1),
            ("finger_xy_per_m", numpy.nan),
            ("thickness_m", 1e-300),  # overflows
            ("thickness_m", numpy.ma.masked),
        ):
            two = numpy.ma.array([PAD.get(name, 0.0)] * 2)
            two[1] = value
            contact = arrays.fingertip_layer(**{**PAD, name: two}, with_stiffness=True)
            bound = arrays.error_bound(**{**PAD, name: two})
            for number in contact:
                self.assertEqual(numpy.isnan(number).tolist(), [False, True], name)
            for number in bound:
                self.assertEqual(numpy.isinf(number).tolist(), [False, True], name)
        pad = softfinger.FlatPad.disc(20e-3)
        answer = arrays.pad_layer(pad, **FLAT_PAD, normal_force_N=numpy.array([20.0, numpy.nan]))
        self.assertEqual(numpy.isnan(answer.max_torque_Nm).tolist(), [False, True])
        self.assertEqual(numpy.isinf(answer.torque_bound).tolist(), [False, True])

    def test_without_friction_there_is_no_torque_which_is_an_answer(self):
        contact = arrays.fingertip_layer(**{**PAD, "friction_coefficient": 0.0})
        self.assertEqual(contact.max_torque_Nm, 0)
        self.assertGreater(contact.a_m, 0)

    def test_what_is_no_array_of_numbers_is_refused(self):
        for wrong, said in (
            (dict(thickness_m="thin"), r"thickness_m = 'thin': allowed: a number or an array"),
            (dict(poisson_ratio=True), r"poisson_ratio = True: allowed: a number or an array"),
            (dict(thickness_m=numpy.ones(2), poisson_ratio=numpy.ones(3)), "broadcast"),
        ):
            with self.assertRaisesRegex(softfinger.InputError, said):
                arrays.fingertip_layer(**{**PAD, **wrong})
        with self.assertRaisesRegex(TypeError, "did you mean thickness_m"):
            arrays.fingertip_layer(**PAD, thicknes_m=1.0)
        with self.assertRaisesRegex(softfinger.InputError, "did you mean bonded_layer"):
            arrays.error_bound("bonded", **PAD)

    @needs_torch
    def test_whole_numbers_of_a_tensor_are_refused(self):
        with self.assertRaisesRegex(softfinger.InputError, "normal_force_N.*float32 or float64"):
            arrays.fingertip_layer(**{**PAD, "normal_force_N": torch.tensor([1, 2])})

    def test_the_ellipsoid_is_that_of_the_package(self):
        random = numpy.random.default_rng(7)
        limits = numpy.append(random.uniform(0.1, 2, (50, 2)), [[0, 0], [1, 0]], axis=0)
        wrenches = numpy.append(random.normal(size=(50, 3)), numpy.zeros((2, 3)), axis=0)
        wrenches[-1, 2] = 1e-3  # a torque on a point contact
        found = arrays.utilisation(*limits.T, *wrenches.T)
        expected = softfinger.FrictionEllipsoid(*limits.T).utilisation(wrenches)
        numpy.testing.assert_allclose(found, expected, rtol=VALUES)
        self.assertTrue(numpy.isnan(arrays.utilisation(numpy.nan, 1.0, 0.0, 0.0, 0.0)))


class Samples(unittest.TestCase):
    DOUBTS = dict(
        youngs_modulus_factor=2.0, thickness_factor=1.2, friction_factor=1.5, poisson_ratio_std=0.03
    )

    def test_moments_are_those_of_a_plain_monte_carlo_through_the_compiled_model(self):
        """Means and correlations of two independent draws of n fingers differ by sqrt(2/n) standard
        deviations. Chance does not leave five of these."""
        count = 40_000
        drawn = arrays.sample(count, 1, **PAD, **self.DOUBTS)
        random = numpy.random.default_rng(1_000_003)
        nu = PAD["poisson_ratio"] + 0.03 * random.standard_normal(2 * count)
        numbers = {
            "youngs_modulus_Pa": 3e5 * 2 ** (random.standard_normal(count) / 2),
            "thickness_m": 2e-3 * 1.2 ** (random.standard_normal(count) / 2),
            "friction_coefficient": 0.8 * 1.5 ** (random.standard_normal(count) / 2),
            "poisson_ratio": nu[nu <= 0.5][:count],
        }
        plain = softfinger.predict_with_gradient(**{**PAD, **numbers}, model="fingertip_layer")

        def moments(stiffness, mu, arm):
            logs = numpy.log(numpy.stack([stiffness, mu, arm]))
            return logs.mean(axis=1), logs.std(axis=1), numpy.corrcoef(logs)

        found = moments(
            drawn.contact.normal_stiffness_N_per_m,
            drawn.friction_coefficient,
            drawn.contact.eccentricity_m,
        )
        expected = moments(
            numpy.asarray(plain.normal_stiffness_N_per_m),
            numbers["friction_coefficient"],
            numpy.asarray(plain.prediction.torque_arm_exact_m),
        )
        chance = 5 * numpy.sqrt(2 / count)
        self.assertLess(numpy.max(abs(found[0] - expected[0]) / expected[1]), chance)
        # A standard deviation is known to 1/sqrt(2 n) of itself where the tails are normal.
        self.assertLess(numpy.max(abs(found[1] / expected[1] - 1)), chance)
        self.assertLess(numpy.max(abs(found[2] - expected[2])), chance)
        # A stiff finger has a small contact: that is what drawing the three apart would lose.
        self.assertLess(found[2][0, 2], -0.5)
        print("correlation of stiffness, mu and e_n:", numpy.round(found[2], 3).tolist())

    def test_a_finger_is_one_in_all_of_its_contacts_and_a_seed_repeats_it(self):
        loads_N = numpy.array([0.5, 1.0, 2.0])
        arguments = {**PAD, **self.DOUBTS, "normal_force_N": loads_N}
        drawn = arrays.sample(100, 4, **arguments)
        self.assertEqual(drawn.youngs_modulus_Pa.shape, (100, 1))
        self.assertEqual(drawn.contact.a_m.shape, (100, 3))
        self.assertTrue((drawn.contact.a_m[:, 1:] > drawn.contact.a_m[:, :-1]).all())
        again, other = (arrays.sample(100, seed, **arguments) for seed in (4, 5))
        numpy.testing.assert_array_equal(again.contact.a_m, drawn.contact.a_m)
        self.assertFalse((other.contact.a_m == drawn.contact.a_m).any())

    def test_without_a_doubt_all_fingers_are_the_same(self):
        drawn = arrays.sample(3, 1, **PAD, model="bonded_layer")
        expected = softfinger.predict(**PAD, model="bonded_layer")
        self.assertLess(largest_error(drawn.contact.a_m, expected.a_m), VALUES)

    @needs_torch
    def test_torch_gets_the_same_fingers(self):
        arguments = {**PAD, **self.DOUBTS}
        expected = arrays.sample(100, 4, **arguments)
        arguments["normal_force_N"] = torch.tensor(PAD["normal_force_N"], dtype=torch.float64)
        found = arrays.sample(100, 4, **arguments)
        self.assertIsInstance(found.contact.a_m, torch.Tensor)
        self.assertLess(largest_error(found.contact.a_m, expected.contact.a_m), VALUES)

    def test_what_cannot_be_drawn_is_refused(self):
        for wrong, said in (
            (dict(count=0), "count = 0: allowed: a whole number from 1"),
            (dict(seed=-1), "seed = -1"),
            (dict(thickness_factor=0.5), "thickness_factor = 0.5: allowed: 1 or more"),
            (dict(poisson_ratio=0.6), "poisson_ratio = 0.6"),
            (dict(thickness_m=numpy.ones(2)), "thickness_m.*one number"),
            (dict(model="hertz"), "model = 'hertz'"),
        ):
            with self.assertRaisesRegex(softfinger.InputError, said):
                arrays.sample(**{"count": 2, "seed": 1, **PAD, **wrong})


if __name__ == "__main__":
    unittest.main()
