# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a kernel uses comes with its text, and runs compiled as it does in plain Python."""

from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
import math
from math import hypot
import os
import subprocess
import sys
from typing import NamedTuple

from lta_config.compilation.extract import GeneratedFunction, SourceExtract
from lta_config.errors import BadInput
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import KernelEffect, VehicleMotion
from lta_sim.kernels import kernel, row, thread
from lta_sim.kernels.compose import render_kernel_source
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from . import crowded

PAIR = (2.0, 3.0)
HALF = 0.5


def square(x: float) -> float:
    return x * x


def good(x: float) -> float:
    return HALF * square(x) + PAIR[1] + math.sqrt(abs(x)) + hypot(x, x)


def shadow(HALF: float) -> float:
    return HALF + 1.0


def of_motion(z: float) -> VehicleMotion:
    three = (0.0,) * 3
    return VehicleMotion((0.0, 0.0, z), (0.0,) * 9, three, three, three, three, three, three)


def bad(x: float) -> str:
    return os.sep * int(x)


def text_of(*functions):
    extract = SourceExtract()
    names = [extract.add_function(function, 'box') for function in functions]
    text = extract.render_pieces('@plain')
    space = {'math': math, 'plain': lambda function: function}
    exec('from collections import namedtuple\n' + text, space)
    return text, [space[name] for name in names]


def test_the_text_computes_the_same():
    _, (copy, shadowed) = text_of(good, shadow)
    assert copy(3.0) == good(3.0)
    assert shadowed(1.0) == 2.0


def test_named_tuples_come_along():
    _, (copy,) = text_of(of_motion)
    assert copy(2.0) == of_motion(2.0)
    assert copy(2.0)._fields == VehicleMotion._fields


def test_a_constant_is_part_of_the_text(monkeypatch):
    before, _ = text_of(good)
    monkeypatch.setitem(good.__globals__, 'HALF', 0.25)
    after, _ = text_of(good)
    assert before != after


@pytest.mark.parametrize(
    ('function', 'word'), [(bad, 'os, a module'), (len, 'not a plain function')]
)
def test_what_cannot_be_compiled_is_refused(function, word):
    with pytest.raises(BadInput, match=word):
        text_of(function)


def test_a_function_within_a_function_is_refused():
    def square(x: float) -> float:
        return x

    with pytest.raises(BadInput, match='square cannot be compiled, because it is not defined at'):
        text_of(square)


def test_two_things_of_one_name_are_called_by_their_file_and_then_refused(tmp_path):
    extract = SourceExtract()
    functions = []
    for k in range(3):
        path = tmp_path / str(k) / 'same.py'
        path.parent.mkdir()
        path.write_text(f'def give():\n    return {k}\n')
        spec = spec_from_file_location('same', path)
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        functions.append(module.give)
    assert extract.add_function(functions[0], 'box') == 'box_give'
    assert extract.add_function(functions[1], 'box') == 'box_same_give'
    with pytest.raises(BadInput, match='box_same_give'):
        extract.add_function(functions[2], 'box')


class Plant(NamedTuple):
    rates: GeneratedFunction = GeneratedFunction('rates')


def changes(plant, state):
    return plant.rates(state)


def hidden(plant, state):
    rates = 2.0
    return plant.rates(state) * rates


def local(state):
    plant = (state, 1.0)
    return plant[0]


def test_a_generated_function_is_called_by_its_name():
    extract = SourceExtract(plant=Plant())
    extract.add_function(changes, 'box')
    assert 'def box_changes(state):\n    return rates(state)' in extract.render_pieces('')
    with pytest.raises(TypeError, match='rates exists only in compiled code and cannot be'):
        changes(Plant(), 1.0)


def test_a_variable_that_would_hide_a_generated_function_is_refused():
    with pytest.raises(BadInput, match='has a variable rates'):
        SourceExtract(plant=Plant()).add_function(hidden, 'box')


def test_a_variable_that_is_called_like_a_bound_argument_stays():
    extract = SourceExtract(plant=Plant())
    extract.add_function(local, 'box')
    assert 'plant = (state, 1.0)' in extract.render_pieces('')


def test_the_kernel_needs_numba_only():
    source = render_kernel_source(EFFECTS)
    imports = [line for line in source.splitlines() if line.startswith(('import', 'from'))]
    assert imports == [
        'from collections import namedtuple',
        'import math',
        'from numba import njit',
    ]
    for name, effect in EFFECTS.items():
        assert isinstance(effect, KernelEffect) == (f'def {name}_' in source)


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
