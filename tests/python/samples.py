"""Contacts that several tests ask about."""

import os
import unittest

import numpy

import softfinger

#: A 2 mm silicone pad on a fingertip.
PAD = dict(
    normal_force_N=2.0,
    youngs_modulus_Pa=300e3,
    poisson_ratio=0.45,
    thickness_m=2e-3,
    radius_major_m=20e-3,
    radius_minor_m=5e-3,
    friction_coefficient=0.8,
)

FAST_MODELS = [name for name, card in softfinger.models().items() if card.is_fast]


def random_contacts(count, seed=1):
    """From fingertips to somewhat beyond."""
    random = numpy.random.default_rng(seed)
    minor_m = 0.01 * numpy.exp(random.uniform(-1, 1, count))
    major_m = minor_m * numpy.exp(random.uniform(0, 2, count))
    return dict(
        normal_force_N=numpy.exp(random.uniform(-3, 3, count)),
        youngs_modulus_Pa=3e5 * numpy.exp(random.uniform(-1, 1, count)),
        poisson_ratio=random.uniform(0, 0.5, count),
        thickness_m=0.002 * numpy.exp(random.uniform(-1, 1, count)),
        radius_major_m=major_m,
        radius_minor_m=minor_m,
        friction_coefficient=random.uniform(0.1, 1.5, count),
        finger_xx_per_m=random.uniform(0, 1, count) / major_m,
        finger_yy_per_m=random.uniform(0, 1, count) / minor_m,
    )


def needs_program(test):
    """Skips a test where the program `softfinger` was not built."""
    return unittest.skipUnless(os.environ.get("SOFTFINGER_PROGRAM"), "no program softfinger")(test)
