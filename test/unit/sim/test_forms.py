# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One vehicle compiled, and the text as plain Python: the same to the bit."""

from functools import cache
import os
import subprocess
import sys

from lta_config.errors import BadInput
from lta_model.effects import EFFECTS
from lta_sim.kernels import kernel, row, thread
from lta_sim.kernels.compose import render_kernel_source
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from . import crowded

STEP, COUNT = 2e-3, 24
SETS = ('all', 'some', 'few', 'none')


def names_of(kind, generator):
    """Return which effects of a random vehicle are on."""
    share = {'all': 1.0, 'some': 0.5, 'few': 0.1, 'none': 0.0}[kind]
    return [name for name in EFFECTS if generator.random() < share]


@cache
def fleet(seed, kinds):
    """Return vehicles with random sets of effects on, and random states, commands and air."""
    generator = np.random.default_rng(seed)
    models = [
        crowded.vehicle(generator, names_of(kinds[k % len(kinds)], generator))[2]
        for k in range(COUNT)
    ]
    flights = [crowded.anywhere(generator) for _ in models]
    return models, *(np.array(column) for column in zip(*flights, strict=True))


def alone(models, states, commands, around, steps):
    """Return what the compiled kernel of one vehicle makes of each."""
    return np.array(
        [
            kernel.advance(state, model, command, air, STEP, steps)
            for model, state, command, air in zip(models, states, commands, around, strict=True)
        ]
    )


@pytest.fixture(scope='module')
def text():
    """Return `advance` of the kernel's text as plain, slow Python."""
    source = render_kernel_source(EFFECTS).replace('from numba import njit', '')
    space = {'njit': lambda **_: lambda function: function}
    exec(source, space)
    return space['advance']


def in_python(advance, model, state, command, around, steps):
    """Return the later state by the text, from a list of floats."""
    where = row.row_slices(SIM_LAYOUT)
    numbers = [0.0] * where['wind'].stop
    for name, values in {
        'state': state,
        'parameters': model.parameters,
        'body': model.body,
        'inverse': model.inverse,
        'command': command,
        'surroundings': around,
    }.items():
        numbers[where[name]] = values.tolist()
    advance(numbers, model.on.tolist(), STEP, steps)
    return numbers[where['state']]


@pytest.mark.parametrize('kinds', [('all',), SETS])
def test_compiled_as_written(text, kinds):
    models, states, commands, around = fleet(11, kinds)
    compiled = alone(models, states, commands, around, 20)
    for model, state, command, air, later in zip(
        models, states, commands, around, compiled, strict=True
    ):
        np.testing.assert_array_equal(later, in_python(text, model, state, command, air, 20))


def test_the_flights_are_of_different_sets():
    models, states, commands, around = fleet(0, SETS)
    assert len({model.on.tobytes() for model in models}) > COUNT // 2
    assert any(model.on.all() for model in models)
    assert np.isfinite(alone(models, states, commands, around, 100)).all()


def test_without_numba_cuda_a_gpu_says_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, 'numba.cuda', None)
    with pytest.raises(BadInput, match=r'Cannot import numba-cuda .*; install the packages'):
        thread.require_cuda()


def test_without_a_gpu_it_says_what_to_do():
    pytest.importorskip('numba.cuda')
    script = 'from lta_sim.kernels.thread import require_cuda; require_cuda()'
    done = subprocess.run(
        [sys.executable, '-c', script],
        env=os.environ
        | {'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
        | {'NUMBA_ENABLE_CUDASIM': '0', 'CUDA_VISIBLE_DEVICES': '-1'},
        capture_output=True,
        text=True,
        check=False,
    )
    assert 'numba-cuda finds no GPU; use a machine with an NVIDIA GPU' in done.stderr
