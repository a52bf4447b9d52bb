# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A model is refused in one sentence, or it is a body that can exist."""

from lta_model.effects import EFFECTS
from lta_model.effects.protocol import KernelEffect
from lta_model.model import VehicleModel
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from . import flat_balloon as balloon


def build(given=None, mass=0.3, cg=(0.0, 0.0, 0.0), inertia=None):
    inertia = np.eye(3) if inertia is None else inertia
    return VehicleModel.build(given or {}, mass=mass, cg=cg, inertia=inertia)


def test_what_is_left_out_is_null():
    nulls = {
        name: {parameter.name: parameter.null for parameter in effect.parameters}
        for name, effect in EFFECTS.items()
    }
    for one, two in zip(vectors(build()), vectors(build(nulls)), strict=True):
        assert one.tobytes() == two.tobytes()


def test_inertia_by_elements():
    tensor = np.array([[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]])
    one, two = build(inertia=tensor), build(inertia=[1.0, 0.1, 0.2, 2.0, 0.3, 3.0])
    np.testing.assert_array_equal(one.inverse, two.inverse)


def test_numbers_of_the_kernel():
    model = balloon.model(balloon.EVERYTHING)
    steiner = 0.015 + 0.358 * 0.08**2
    expected = [
        *(0.358, 0.0, 0.0, -0.358 * 0.08),
        *(steiner, steiner, 0.018, 0.0, 0.0, 0.0),
        *(0.146, 0.146, 0.374, 4.7e-3, 4.7e-3, 0.0),
        balloon.DISPLACED,
    ]
    np.testing.assert_allclose(model.body[:17], expected, rtol=1e-14, atol=1e-18)
    heave = np.reshape(model.inverse, (6, 6))[2, 2]
    assert heave == pytest.approx(1.0 / (0.358 + 0.374), rel=1e-14)
    kernel = [effect for effect in EFFECTS.values() if isinstance(effect, KernelEffect)]
    assert len(model.parameters) == sum(len(effect.parameters) for effect in kernel)
    on = dict(zip(SIM_LAYOUT.effects, model.on.tolist(), strict=True))
    assert {name for name, is_on in on.items() if is_on} == set(balloon.EVERYTHING) & set(on)
    assert set(model.effect_parameters) == set(balloon.EVERYTHING)


def vectors(model):
    return model.parameters, model.on, model.body, model.inverse
