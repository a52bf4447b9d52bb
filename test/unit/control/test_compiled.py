# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The strategies compile as they stand: numba gives what Python gives, to the last bit.

Their source is taken with all that it uses, as the kernel's is, so that a construct that cannot be
compiled fails here and not in the batch that needs it. The rest of a flight step is compiled in
test_flight_step.py and test/property/test_laws.py.
"""

import math
from pathlib import Path
import sys

from lta_config.compilation.extract import SourceExtract
from lta_config.settings import to_named_tuple
from lta_control.laws.cascade import CascadeGains
from lta_control.strategies import find_navigation_strategy, STRATEGIES
from lta_control.strategies.protocol import LightMeasurement
from lta_control.strategies.settings import StrategySettings
from lta_model.vehicle import load_vehicle
import numba
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


def test_plain_settings_are_the_same_numbers():
    gains = to_named_tuple(GAINS)
    assert gains.climb.kp == GAINS.climb.kp
    assert gains._fields == tuple(CascadeGains.model_fields)
