"""Many vehicles at once fly as each of them alone, to the last bit."""

from lta_config.errors import BadInput
from lta_sim.kernels import kernel
from lta_sim.kernels.cpu_batch import advance_many, render_batch_source
from lta_sim.kernels.vehicle_batch import pack_blocks, select_used_numbers, VehicleBatch
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest

from . import flat_balloon as balloon

STEP = 2e-3
SIZE = LAYOUT.size


def scaled(given, generator):
    """Return the parameters of another balloon."""
    return {
        effect: {name: value * generator.uniform(0.8, 1.2) for name, value in values.items()}
        for effect, values in given.items()
    }


def flights(count, seed=1):
    """Return different vehicles, above and in the floor, with states, duties and winds."""
    generator = np.random.default_rng(seed)
    models = [
        balloon.model(scaled(balloon.EVERYTHING, generator), generator.normal(0.0, 0.03, 3))
        for _ in range(count)
    ]
    starts = [balloon.anywhere(generator) for _ in range(count)]
    states, duties, winds = (np.array(column) for column in zip(*starts, strict=True))
    return models, states, duties, winds


def alone(models, states, duties, winds, dt, steps):
    """Return what the scalar kernel makes of each vehicle."""
    return np.array(
        [
            kernel.advance(state, model, duty, wind, dt, steps)
            for state, model, duty, wind in zip(states, models, duties, winds, strict=True)
        ]
    )


def test_what_is_lost_stays_its_own(steps):
    models, states, duties, winds = flights(20)
    states[3] = np.nan
    many = advance_many(states, VehicleBatch.from_models(models), duties, winds, STEP, steps)
    expected = alone(models, states, duties, winds, STEP, steps)
    assert np.isnan(many[3]).all()
    np.testing.assert_array_equal(many, expected)


def test_nothing_is_written_into_what_was_given(steps):
    models, states, duties, winds = flights(3)
    before = states.copy()
    assert np.array_equal(
        advance_many(states, VehicleBatch.from_models(models), duties, winds, STEP, 0)[:, :3],
        before[:, :3],
    )
    advance_many(states, VehicleBatch.from_models(models), duties, winds, STEP, steps)
    np.testing.assert_array_equal(states, before)


@pytest.mark.parametrize(
    ('part', 'shape', 'words'),
    [
        (0, (3, 13), rf'states have the shape \(3, 13\); it must be \(3, {SIZE}\)'),
        (0, (2, SIZE), rf'states have the shape \(2, {SIZE}\)'),
        (1, (3, 12), r'commands have the shape \(3, 12\)'),
        (2, (1, 3), r'surroundings have the shape \(1, 3\)'),
    ],
)
def test_wrong_shapes_are_refused(part, shape, words):
    models, *arrays = flights(3)
    arrays[part] = np.zeros(shape)
    states, duties, winds = arrays
    with pytest.raises(ValueError, match=words):
        advance_many(states, VehicleBatch.from_models(models), duties, winds, STEP, 1)


def test_only_what_some_vehicle_has_on_is_compiled():
    """Effects that are off, absent strips and absent rotors have no code."""
    models, states, duties, winds = flights(2)
    models.append(balloon.model({'linear_drag': {'surge': 0.1}}))
    used = select_used_numbers(
        states[[0, 1, 1]], VehicleBatch.from_models(models), duties[[0, 1, 1]], winds[[0, 1, 1]]
    )
    on = set().union(*(model.effect_parameters for model in models))
    assert used.names == tuple(name for name in LAYOUT.effects if name in on)
    values = used.fixed[0]
    assert used.zeros == {k for k in range(values.shape[1]) if not values[:, k].any()}
    source = render_batch_source(used.names, used.zeros, used.rotors)
    for name in LAYOUT.effects:
        assert (f'def {name}_{name}(' in source) == (name in on)
    assert f'for j in range({used.rotors}):' in source
    few = render_batch_source(('strip_damping',), frozenset({0, 1}), 4)
    assert 'p = ((0.0, 0.0, block[2 * WIDTH + i], ' in few


@pytest.mark.parametrize('has', ['command', 'memory', 'nothing'])
def test_a_rotor_counts_that_has_a_command_or_a_memory(has):
    models, states, duties, winds = flights(3)
    commands = np.zeros((3, 8))
    commands[:, : duties.shape[1]] = duties
    states[:, balloon.LAG.stop : balloon.LAG.start + 8] = 0.0
    if has == 'command':
        commands[1, 6] = 0.1
    elif has == 'memory':
        states[1, balloon.LAG.start + 6] = 0.1
    used = select_used_numbers(states, VehicleBatch.from_models(models), commands, winds)
    assert used.rotors == (7 if has != 'nothing' else 4)


def test_blocks_are_filled_with_the_last_vehicle():
    packed = pack_blocks([np.arange(6.0).reshape(3, 2), 10.0 + np.arange(3.0)[:, None]], 2)
    np.testing.assert_array_equal(packed, [[[0, 2], [1, 3], [10, 11]], [[4, 4], [5, 5], [12, 12]]])


def test_no_fleet_of_nobody():
    with pytest.raises(BadInput, match='at least one vehicle, but none'):
        VehicleBatch.from_models([])
