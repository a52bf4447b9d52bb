# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The kernel and the slow, obvious model agree, effect by effect and with everything on.

Everything is what the library has: an effect that others installed has no second model here, and
is off.
"""

from lta_model.effects import BUILT_IN, select_built_in_effects
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)
from lta_sim.kernels import kernel
import numpy as np
import pytest

from . import crowded
from .oracle import motion as oracle
from .oracle.air import AIR
from .oracle.body import BODY, INERTIA
from .oracle.rotors import ROTORS

PLACES = {name: place for name, place in crowded.memory_places().items() if name in BUILT_IN}
TOLERANCE = 1e-12
BLOCKS = {'position': slice(0, 3), 'attitude': slice(3, 7), 'motion': slice(7, 13)} | {
    name: where for name, where in PLACES.items() if where.stop > where.start
}


def kind(kind_):
    return [
        name for name, effect in select_built_in_effects().items() if isinstance(effect, kind_)
    ]


def own(wrenches):
    """Return the wrenches of the library's effects."""
    return {name: wrench for name, wrench in wrenches.items() if name in BUILT_IN}


def error(actual, expected):
    """Return the largest error by the largest number."""
    scale = np.max(abs(np.asarray(expected)))
    return np.max(abs(np.subtract(actual, expected))) / (scale if scale > 0.0 else 1.0)


def drawn(seed, names=BUILT_IN):
    """Return a random vehicle as both models take it, and a random state."""
    generator = np.random.default_rng(seed)
    given, body, model = crowded.vehicle(generator, names)
    return model, oracle.Vehicle(given, **body), crowded.anywhere(generator)


def test_every_effect_has_an_oracle_in_its_order():
    """A new effect of the library is written twice: for the kernel, and from its docstring."""
    assert list(AIR) == kind(AirEffect)
    assert list(ROTORS) == kind(ActuatorEffect)
    assert list(BODY) == kind(BodyEffect)
    assert list(INERTIA) == kind(InertiaEffect)
    assert set(oracle.WRENCHES) == set(kind(WrenchEffect))
    assert set(select_built_in_effects()) == set(oracle.KNOWN) | set(kind(MeasurementEffect))


@pytest.mark.parametrize('seed', range(60))
def test_derivative(seed):
    model, twin, (state, command, around) = drawn(seed)
    expected = oracle.derivative(state, twin, PLACES, command, around)
    actual = kernel.state_derivative(state, model, command, around)
    for name, block in BLOCKS.items():
        assert error(actual[block], expected[block]) <= TOLERANCE, name


@pytest.mark.parametrize('seed', range(60))
def test_each_wrench_the_thrusts_and_the_wind(seed):
    model, twin, (state, command, around) = drawn(seed)
    scene, _, thrusts, wrenches, _ = oracle.look(state, twin, PLACES, command, around)
    look = kernel.evaluate_model(state, model, command, around)
    assert error(look.thrusts, thrusts) <= TOLERANCE
    assert error(look.wind, scene.wind) <= TOLERANCE
    assert set(own(look.wrenches)) == set(wrenches)
    for name, wrench in wrenches.items():
        assert error(look.wrenches[name], wrench) <= TOLERANCE, name


@pytest.mark.parametrize('seed', range(3))
def test_flight(seed):
    model, twin, (state, command, around) = drawn(seed)
    expected = oracle.advance(state, 2e-3, 20, twin, PLACES, command, around)
    actual = kernel.advance(state, model, command, around, 2e-3, 20)
    for name, block in BLOCKS.items():
        assert error(actual[block], expected[block]) <= TOLERANCE, name


@pytest.mark.parametrize('name', oracle.KNOWN)
def test_alone(name):
    """With weight, added mass, a rotor's push and one effect: nothing larger hides its error."""
    beside = ('weight_and_buoyancy', 'added_mass', 'rotor_thrust')
    for seed in range(12):
        model, twin, (state, command, around) = drawn(seed, (*beside, name))
        expected = oracle.derivative(state, twin, PLACES, command, around)
        actual = kernel.state_derivative(state, model, command, around)
        for block in BLOCKS.values():
            assert error(actual[block], expected[block]) <= TOLERANCE
        rigid = [model.body[0], *model.body[1:4], model.body[16]]
        body = twin.body
        twins = [body.mass, *(body.mass * body.cg), body.displaced]
        assert error(rigid, twins) <= TOLERANCE


def test_the_random_states_meet_every_effect():
    """Each wrench is there in some states, and each soft face is left alone in some."""
    met = dict.fromkeys(kind(WrenchEffect), 0)
    for seed in range(60):
        model, _, (state, command, around) = drawn(seed)
        for name, wrench in own(kernel.effect_wrenches(state, model, command, around)).items():
            met[name] += bool(np.any(wrench))
    assert min(met.values()) >= 5, met
    assert max(met['floor_contact'], met['walls']) <= 57, met
