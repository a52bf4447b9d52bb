"""One vehicle compiled, many side by side, and the text as plain Python: the same to the bit."""

from functools import cache

from lta_model.effects import EFFECTS
from lta_sim.kernels import kernel, row
from lta_sim.kernels.compose import render_kernel_source
from lta_sim.kernels.cpu_batch import advance_many
from lta_sim.kernels.vehicle_batch import VehicleBatch
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest

from . import crowded

STEP, COUNT = 2e-3, 24
SETS = ('all', 'some', 'few', 'none')


def names_of(kind, generator):
    """Return which effects of a random vehicle are on."""
    share = {'all': 1.0, 'some': 0.5, 'few': 0.1, 'none': 0.0}[kind]
    return [name for name in EFFECTS if generator.random() < share]


@cache  # both forms are compared on the same fleet
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


# Mixed kinds share a block of the batched kernel, which runs what any vehicle in it has on.
@pytest.mark.parametrize('kinds', [SETS, *((kind,) for kind in SETS)])
@pytest.mark.parametrize('seed', range(4))
def test_side_by_side_as_alone(seed, kinds, steps):
    models, states, commands, around = fleet(seed, kinds)
    many = advance_many(states, VehicleBatch.from_models(models), commands, around, STEP, steps)
    np.testing.assert_array_equal(many, alone(models, states, commands, around, steps))


def in_python(advance, model, state, command, around, steps):
    """Return the later state by the text, from a list of floats."""
    where = row.row_slices(LAYOUT)
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
