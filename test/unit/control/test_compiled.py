"""
The cores compile as they stand: numba gives what Python gives, to the last bit.

Their source is taken with all that it uses, as the kernel's is, so that a construct that cannot be
compiled fails here and not in the loop that needs it.
"""

import math
from pathlib import Path
import sys

from lta_config.compilation.extract import SourceExtract
from lta_config.settings import to_named_tuple
from lta_control.allocation import create_working_array, SCRATCH
from lta_control.attitude import attitude_step
from lta_control.cascade import (
    CascadeGains,
    CascadeMeasurement,
    Setpoint,
    WrenchDemand,
)
from lta_control.estimator import (
    estimator_step,
    EstimatorInputs,
    EstimatorSettings,
    MotionEstimate,
)
from lta_control.laws.cascade import CascadeLawConstants, CascadeLawMemory, control_step
from lta_control.per_rotor import pad_to_slots
from lta_control.strategies import find_navigation_strategy, STRATEGIES
from lta_control.strategies.protocol import LightMeasurement
from lta_control.strategies.settings import StrategySettings
from lta_control.vehicle_parameters import build_estimator_model, build_rotors
from lta_model.vehicle import load_vehicle
from lta_vlc.bearing import weighted_mean_bearing
from lta_vlc.diodes import build_even_ring
import numba
import numpy as np
import pytest

from .round_gains import GAINS

VEHICLE = load_vehicle('gtmab')


def list_named_tuples():
    """
    Return every named tuple of the modules loaded so far by its name, which is unique.

    Kernels, which another test may have loaded, have copies of their own.
    """
    found = [
        value
        for name, module in list(sys.modules.items())
        if name.startswith('lta_') and not name.startswith('lta_kernel_')
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, '_fields')
    ]
    return {kind.__name__: kind for kind in found}


def compiled(function):
    """Return a function compiled from its own source and all that it uses."""
    extract = SourceExtract()
    name = extract.add_function(function, 'core')
    # The compiled text makes its named tuples anew; here they must be the ones that Python uses.
    known = list_named_tuples()
    space = {'math': math, 'namedtuple': lambda name, _: known[name], 'njit': numba.njit}
    exec(extract.render_pieces('@njit'), space)
    return space[name]


def numbers(value):
    """Return all numbers of nested tuples, in order."""
    if isinstance(value, tuple):
        return [number for item in value for number in numbers(item)]
    return [value]


@pytest.mark.long
def test_control_compiles():
    fast, generator = compiled(control_step), np.random.default_rng(1)
    constants = CascadeLawConstants(to_named_tuple(GAINS), build_rotors(VEHICLE), (0.001, 0.092))
    slow = quick = CascadeLawMemory()
    scratch = np.full(SCRATCH, math.nan)
    for _ in range(300):
        measured = CascadeMeasurement(*generator.normal(0.3, 0.5, 7).tolist())
        setpoint = Setpoint(*generator.normal(0.4, 0.4, 3).tolist())
        slow = control_step(constants, slow, measured, setpoint, 0.01, create_working_array())
        quick = fast(constants, quick, measured, setpoint, 0.01, scratch)
        assert numbers(quick) == numbers(slow)
    assert isinstance(slow.shortfall, WrenchDemand)


@pytest.mark.long
def test_the_estimator_compiles():
    fast, generator = compiled(estimator_step), np.random.default_rng(2)
    settings, body = EstimatorSettings(rest_time=0.5), build_estimator_model(VEHICLE)
    slow = quick = MotionEstimate()
    for k in range(400):
        shaken = 0.1 if k < 60 and k != 5 else 1.0  # at rest but for a jolt, and then in flight
        rates = generator.normal(0.0, 0.2 * shaken, 3)
        force = generator.normal(0.0, 0.5 * shaken, 3)
        inputs = EstimatorInputs(
            tuple(rates.tolist()),
            (float(force[0]), float(force[1]), 9.8 + float(force[2])),
            float(generator.normal(0.1, 0.01)) if k % 3 else math.inf,
            float(generator.normal(1e5, 2.0)) if k % 2 else math.nan,
            pad_to_slots(generator.uniform(0.0, 1.0, 4).tolist()),
        )
        slow = estimator_step(settings, body, slow, inputs, 0.01)
        quick = fast(to_named_tuple(settings), body, quick, inputs, 0.01)
        assert numbers(quick) == numbers(slow)
    assert slow.ready
    assert slow.flight_time == pytest.approx(
        3.44
    )  # the rest of 0.5 s began anew at the seventh step


def test_the_attitude_filter_compiles():
    fast = compiled(attitude_step)
    arguments = ((0.1, -0.2, 0.3, math.sqrt(0.86)), (0.5, 0.4, -0.3), (0.1, 0.2, 9.7), 0.1, 0.01)
    assert fast(*arguments) == attitude_step(*arguments)


OWN = str(Path(__file__).resolve().parents[3] / 'examples' / 'own_strategy.py')
LONG = ('homing', 'dga')  # with the filter of the lamp, which takes ten seconds to compile


@pytest.mark.parametrize(
    'name',
    [pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in STRATEGIES]
    + [OWN],
)
def test_every_strategy_compiles(name):
    strategy, settings = find_navigation_strategy(name), StrategySettings()
    start, steer = compiled(strategy.start), compiled(strategy.steer)
    memory = strategy.start(0.7)
    assert start(0.7) == memory
    for seen in (True, False, False, True):
        light = (0.02, 800.0, 0.1) if seen else (0.0, 0.0, 0.0)
        bearing, place = 0.3 if seen else 0.0, (0.4, -0.2)
        sight = LightMeasurement(
            seen, bearing, -1.2, (1.0, 2.0, 3.0, 4.0), 0.1, *light, place, (0.5, 0.1)
        )
        fast = steer(to_named_tuple(settings), memory, sight)
        course, memory = strategy.steer(settings, memory, sight)
        assert numbers(fast) == numbers((course, memory))


def test_the_bearing_compiles():
    fast, generator = compiled(weighted_mean_bearing), np.random.default_rng(3)
    ring = build_even_ring(8).ring
    for _ in range(50):
        amplitudes = tuple(generator.uniform(0.0, 500.0, 8).tolist())
        snrs = tuple(generator.uniform(0.0, 30.0, 8).tolist())
        arguments = (amplitudes, snrs, ring.cosines, ring.sines, 6.0)
        assert numbers(fast(*arguments)) == numbers(weighted_mean_bearing(*arguments))


def test_plain_settings_are_the_same_numbers():
    gains = to_named_tuple(GAINS)
    assert gains.climb.kp == GAINS.climb.kp
    assert gains._fields == tuple(CascadeGains.model_fields)
