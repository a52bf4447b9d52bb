# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Nests of tuples as flat arrays: there and back, and in compiled code."""

import math
from typing import NamedTuple

from lta_config.compilation.flat import compile_core, TupleLayout
from lta_config.settings import setting, Settings, to_named_tuple
import numpy as np


class Inner(NamedTuple):
    count: int = 3
    on: bool = True


class Outer(NamedTuple):
    pair: tuple[float, float] = (0.1, math.nan)
    inner: Inner = Inner()
    last: float = -0.5


class Weights(Settings):
    heavy: float = setting(2.0, low=0.0)
    """A weight."""


class Constants(NamedTuple):
    weights: Weights
    half: float


class Given(NamedTuple):
    value: float


def core(constants, memory, given, scratch):
    scratch[0] += 1.0
    inner = memory.inner
    if given.value > 0.0:
        inner = Inner(inner.count + 1, not inner.on)
    first = constants.weights.heavy * given.value
    return Outer((first, memory.pair[0]), inner, constants.half)


def test_the_layout_is_in_order():
    layout = TupleLayout(Outer())
    assert layout.paths == ('pair[0]', 'pair[1]', 'inner.count', 'inner.on', 'last')


def test_a_record_shares_the_numbers():
    array = TupleLayout(Outer()).write(Outer((0.3, 0.4), Inner(-7, False), 1.0))
    record = TupleLayout(Outer()).view(array)
    assert record['pair'].tolist() == [0.3, 0.4]
    assert record['inner'].item() == (-7.0, 0.0)
    record['inner'] = (5.0, 1.0)
    record['last'] = 2.0
    assert array.tolist() == [0.3, 0.4, 5.0, 1.0, 2.0]
    assert TupleLayout(Outer()).view(np.array([array, array]))['last'].tolist() == [2.0, 2.0]


def test_there_and_back():
    layout = TupleLayout(Outer())
    array = layout.write(Outer((0.3, math.inf), Inner(-7, False), 1.0))
    assert array.tolist() == [0.3, math.inf, -7.0, 0.0, 1.0]
    back = layout.read(array)
    assert back == Outer((0.3, math.inf), Inner(-7, False), 1.0)
    assert type(back.inner.count) is int
    assert back.inner.on is False


def test_settings_are_numbers_too():
    layout = TupleLayout(Constants(Weights(heavy=4.0), 0.5))
    assert layout.paths == ('weights.heavy', 'half')
    assert layout.write(Constants(Weights(heavy=3.0), 0.25)).tolist() == [3.0, 0.25]
    assert layout.read(np.array([1.0, 2.0])) == Constants(to_named_tuple(Weights(heavy=1.0)), 2.0)


def test_compiled_it_is_the_same_function(monkeypatch, tmp_path):
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path))
    constants, memory = Constants(Weights(), 0.5), Outer()
    layouts = TupleLayout(constants), TupleLayout(memory), TupleLayout(Given(0.0))
    step = compile_core(core, *layouts)
    scratch, array = np.zeros(1), layouts[1].write(memory)
    for value in (0.7, -0.2, 1.5):
        memory = core(constants, memory, Given(value), [0.0])
        step(layouts[0].write(constants), array, np.array([value]), scratch)
        assert layouts[1].read(array) == memory
    assert scratch[0] == 3.0
    assert list(tmp_path.rglob('*.nbi'))  # kept
