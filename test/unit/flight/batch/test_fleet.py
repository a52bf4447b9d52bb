# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A batch flies what the loop flies: the same parts, and the same on a GPU."""

from dataclasses import replace
from functools import partial
from importlib.util import find_spec
import math
import os
import subprocess
import sys
import textwrap

from lta_config.errors import BadInput
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table
from lta_control.motion import Setpoint
from lta_flight.batch import batch_flight, flight
from lta_flight.batch.batch_flight import build_flight
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import fly_many
from lta_flight.batch.targets import MODEL
from lta_flight.flight_spec import build_loop, build_vehicle_scenario_stack, load_spec
from lta_flight.loop_view import LoopView
from lta_flight.report.results import compute_results
from lta_flight.sweep.batch_workers import compute_figures
from lta_model.effects import EFFECTS
from lta_model.electrical.mppt_charger import resting_flow
from lta_model.sensors import imu, pressure
from lta_model.sensors import range as range_finder
from lta_model.state import COMMAND, SURROUNDINGS
from lta_sim.kernels import kernel
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.thread import ThreadAccess
from lta_sim.readings import FlightOutcome
from lta_sim.simulated_vehicle import SIM_LAYOUT
from lta_sim.termination import FLYING, REACHED, TIMEOUT
import numpy as np
import pytest

TABLE = load_topic_table()
PERIOD = 1e-9 * TABLE.control_ns  # s
needs_cuda = pytest.mark.skipif(
    find_spec('numba.cuda') is None, reason='this numba needs numba-cuda (requirements-gpu.txt)'
)


def ingredients(*changes, scene='lamp_room'):
    return load_spec('gtmab', scene, 'bag', 'gtmab').with_values(
        dict(map(parse_assignment, changes))
    )


def made(*changes, scene='lamp_room'):
    return build_flight(*build_vehicle_scenario_stack(ingredients(*changes, scene=scene)), TABLE)


def figures(row):
    return dict(zip(FIGURES, row.tolist(), strict=True))


def test_numbers_that_run_away_end_a_flight():
    craft = made().craft
    cell, tally = flight.initial_supply(0.9), flight.initial_tally(craft)
    for k, value, outcome in (
        (7, 999.0, FLYING),
        (9, -1001.0, flight.RAN_AWAY),
        (12, math.nan, flight.RAN_AWAY),
    ):
        state = [*craft.place, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6]
        state[k] = value
        assert (
            flight.update_tally(craft, tally, (0.0, 0.0), state, cell, 0.01, 0.01).outcome
            == outcome
        )


BRIEF = (
    'scenario.goal.time_limit=0.25 s',
    'estimator.rest_time=0.15',
    'scenario.start.charge=60 %',
)


def with_record(spec, path, turn):
    """Return a flight in a recorded wind that turns at some rate [rad/s]."""
    time = np.arange(0.0, 70.0, 0.7)
    wind = [np.cos(turn * time), np.sin(turn * time), np.sin(3.0 * turn * time)]
    rows = np.column_stack([time, 0.2 * np.array(wind).T])
    np.savetxt(path, rows, delimiter=',', header='t,u,v,w', comments='')
    scene = spec.contents['scenario']
    air = {**scene['air'], 'recorded': str(path)}
    return replace(spec, contents={**spec.contents, 'scenario': {**scene, 'air': air}})


EXACT = {  # settings of the sensors without noise and errors
    'ImuSettings': {
        'acceleration_noise': (0.0, 0.0, 0.0), 'acceleration_offset': 0.0,
        'acceleration_scale': 0.0, 'rate_noise': 0.0, 'rate_offset': 0.0, 'rate_scale': 0.0,
    },
    'RangeSettings': {'noise': 0.0, 'offset': 0.0},
    'PressureSettings': {'noise': 0.0, 'offset': 0.0, 'drift': 0.0},
}  # fmt: skip
ENDING = ('x', 'y', 'z', 'charge', 'path_length', 'end')


def test_without_noise_and_lamp_a_flight_is_that_of_the_world(batches, monkeypatch, tmp_path):
    """In a recorded wind, with a panel that is shorted: all but light and chance, as compiled."""
    for module, name in ((imu, 'ImuSettings'), (range_finder, 'RangeSettings'),
                         (pressure, 'PressureSettings')):  # fmt: skip
        exact = partial(getattr(module, name), **EXACT[name])
        monkeypatch.setattr(module, name, exact)
        monkeypatch.setattr(batch_flight, name, exact)
    seconds = 20 if batches == 'compiled' else 2
    spec = ingredients(
        *BRIEF[1:], f'scenario.goal.time_limit={seconds} s', 'mission.altitude=0.5',
        'scenario.start.heading_spread=0 deg', 'scenario.ambient.steady=20000 lx',
        'scenario.lamp.flux=1e-3 lm', 'scenario.room.size=[40, 40, 3] m',
    )  # fmt: skip
    spec = with_record(spec, tmp_path / 'wind.csv', 0.8)
    scene = spec.contents['scenario'] | {'faults': {'panel_short': '1 s'}}
    spec = replace(spec, contents=spec.contents | {'scenario': scene})
    loop = build_loop(spec, 1)
    world = loop.world
    flown = [[*world.state[:3], world.charge]]
    flown += [[*world.state[:3], world.charge] for _ in loop.iterate_steps()]
    # The loop flies one period more, in which it learns the outcome
    length = np.linalg.norm(np.diff(flown[:-1], axis=0)[:, :2], axis=1).sum()
    expected = [*flown[-2], length, world.elapsed - PERIOD]
    told = figures(fly_many([build_flight(*build_vehicle_scenario_stack(spec), TABLE)], [1])[0])
    assert tuple(FlightOutcome)[int(told['outcome'])] is world.outcome
    np.testing.assert_allclose([told[name] for name in ENDING], expected, rtol=1e-7, atol=1e-7)
    assert length > 0.1


def test_flights_share_recorded_wind_until_its_file_changes(tmp_path):
    path = tmp_path / 'wind.csv'

    def tabulate(turn):
        spec = with_record(ingredients('scenario.goal.time_limit=2 s'), path, turn)
        os.utime(path, ns=(0, round(turn)))
        return build_flight(*build_vehicle_scenario_stack(spec), TABLE).recorded

    first = tabulate(1.0)
    assert tabulate(1.0) is first
    assert abs(tabulate(2.0) - first).max() > 0.01


def test_each_flight_of_a_batch_is_what_it_is_alone(batches, tmp_path):
    """Two of them fly in recorded winds of their own."""
    brief = () if batches == 'compiled' else BRIEF
    changes = ((), ('vehicle.trim.heaviness=4 g',), ('scenario.start.charge=70 %',))
    specs = [ingredients(*brief, *each) for each in changes]
    specs += [with_record(specs[0], tmp_path / f'{k}.csv', k) for k in (1, 2)]
    flights = [build_flight(*build_vehicle_scenario_stack(spec), TABLE) for spec in specs]
    which, seeds = np.array([4, 2, 0, 3, 1, 0, 2]), [1, 1, 1, 1, 2, 3, 1]
    together = fly_many(flights, seeds, which=which)
    alone = [fly_many([flights[w]], [s])[0] for w, s in zip(which, seeds, strict=True)]
    np.testing.assert_array_equal(together, alone)
    np.testing.assert_array_equal(together[1], together[6])
    assert len(np.unique(np.nan_to_num(together), axis=0)) == 6


def test_the_model_of_a_batch_is_that_of_one_vehicle():
    """Written for tuples, it has the rates and thrusts of the compiled kernel."""
    model = made(scene='gusty_hall').model
    effects = {
        name: EFFECTS[name] for name in SIM_LAYOUT.effects if name in model.effect_parameters
    }
    written = {}
    exec(render_kernel_source(effects, KernelTarget('', '', '', ThreadAccess(), MODEL)), written)
    numbers, places = SIM_LAYOUT.find_effect_indices(effects)
    fixed = [*model.parameters[numbers], *model.body, *model.inverse]
    generator = np.random.default_rng(5)
    for _ in range(20):
        state, around = generator.normal(size=SIM_LAYOUT.size), generator.normal(size=SURROUNDINGS)
        command = generator.uniform(-1.0, 1.0, COMMAND)
        told = [state[places].tolist(), fixed, command.tolist(), around.tolist()]
        rates = kernel.state_derivative(state, model, command, around)[places]
        np.testing.assert_allclose(written['rates'](*map(tuple, told)), rates, rtol=1e-12)
        thrusts = kernel.evaluate_model(state, model, command, around).thrusts
        np.testing.assert_allclose(written['thrusts_of'](*map(tuple, told)), thrusts, rtol=1e-12)


SLACK = 'scenario.outside.daylight.slack'
RECORDED = ' in recorded wind'
FIGURES_OF_A_FLIGHT = ('path_length', 'end', 'energy', 'lift_off', 'search_start')


def fly_loops(spec, seeds):
    """Return the results of flights in the one-process loop."""
    flown = []
    for seed in seeds:
        loop = build_loop(spec, seed)
        view = LoopView(loop)
        for _ in loop.iterate_steps():
            view.record_step()
        flown.append(compute_results(view))
    return flown


# Steering, sensing and the end of a flight are the loop's own functions; light and chance differ.
@pytest.mark.long
@pytest.mark.parametrize(
    ('strategy', 'scene'),
    [
        ('bag', 'lamp_room'),
        ('dga', 'lamp_room'),
        ('des', 'lamp_room'),
        ('homing', 'lamp_room'),
        ('homing', 'lamp_room' + RECORDED),
        ('homing', 'hall_door'),  # daylight and wind beyond a door
        ('homing', 'windy_field'),  # held by a hand at first, in gusts
        ('homing', 'warehouse'),  # a route along three lamps
    ],
)
def test_its_flights_are_those_of_the_loop_in_distribution(strategy, scene, tmp_path):
    spec = load_spec('gtmab', scene.removesuffix(RECORDED), strategy, 'gtmab')
    if scene.endswith(RECORDED):
        spec = with_record(spec, tmp_path / 'wind.csv', 0.8)
    if scene == 'hall_door':
        # Beyond the door the sun saturates the vehicle's own 100 kohm, and lifts warm gas
        changes = {'vehicle.sensors.diodes.feedback': '10 kohm', SLACK: '0 %'}
        spec = spec.with_values(changes)
    flown = fly_loops(spec, range(1001, 1013))
    flight_of_batch = build_flight(*build_vehicle_scenario_stack(spec), TABLE)
    rows = fly_many([flight_of_batch], range(60), which=np.zeros(60, int))
    batch = [figures(row) for row in rows]
    reached = [told['outcome'] == REACHED for told in batch]
    share, few = np.mean(reached), np.mean([results.success for results in flown])
    assert abs(share - few) <= 3.5 * math.sqrt(max(share * (1 - share), 0.03) / len(flown))
    # In a door the bearings of a batch are less noisy, and the drone steers with less power.
    compared = FIGURES_OF_A_FLIGHT[:2] if scene == 'hall_door' else FIGURES_OF_A_FLIGHT
    for name in compared:
        own, loop = (np.array([told[name] for told in batch]),
                     np.array([getattr(results, name) for results in flown]))  # fmt: skip
        error = own.std() * math.sqrt(1 / len(loop) + 1 / len(own))
        assert abs(loop.mean() - own.mean()) < 3.5 * error, name


def test_a_route_is_given_as_the_lamps_of_its_stops():
    spec = load_spec('gtmab', 'warehouse', 'homing', 'gtmab')
    spec = spec.with_values({'scenario.route': ['dock', 'gate', 'dock']})
    vehicle, scenario, policy = build_vehicle_scenario_stack(spec)
    craft = build_flight(vehicle, scenario, policy, TABLE).craft
    assert list(scenario.lamps) == ['gate', 'aisle', 'dock']
    assert craft.route == (2, 0, 2)
    assert len(craft.listening.lamps) == len(craft.power.lamp_shares) == 3
    assert craft.goal.stops == ((8.5, -1.5, 0.5), (-3.0, -2.0, 0.5), (8.5, -1.5, 0.5))
    assert made().craft.route == (0,)


def test_the_path_of_a_route_and_the_distance_to_its_last_lamp():
    """Two stops, 3 m and 4 m apart, a radius of 0.5 m: 2.5 + 3 m of path."""
    craft = made().craft
    goal = craft.goal._replace(stops=((3.0, 0.0, 1.0), (3.0, 4.0, 1.0)), radius=0.5, limit=99.0)
    craft = craft._replace(goal=goal, place=(0.0, 0.0, 0.1))
    made_route = replace(build_flight(*build_vehicle_scenario_stack(ingredients()), TABLE),
                         craft=craft)  # fmt: skip
    told = compute_figures(made_route, dict.fromkeys(FIGURES, 1.0), success=True)
    assert told['straight_length'] == pytest.approx(2.5 + 3.0)
    state = (2.8, 0.1, 0.5, *(0.0,) * 10)
    supply = flight.initial_supply(resting_flow(0.9))
    first = flight.initial_tally(craft)
    assert first.closest == 3.0
    after = flight.update_tally(craft, first, (2.7, 0.1), state, supply, 1.0, 0.02)
    # The first lamp is reached: from now on the distance to the second one counts
    assert after.progress.stop == 1
    assert after.closest == pytest.approx(math.hypot(0.2, 3.9))
    above = (*state[:2], 6.85, *state[3:])
    missed = flight.update_tally(craft, first, (2.7, 0.1), above, supply, 1.0, 0.02)
    assert missed.progress.stop == 0


def test_what_a_batch_does_not_know_it_refuses():
    with pytest.raises(BadInput, match=r'does not support the effect gyro_scale'):
        made('vehicle.effects.gyro_scale.z={value: 1.1, unit: "1", source: assumed}')
    sblimp = build_vehicle_scenario_stack(load_spec('sblimp', 'lamp_room', 'bag', ''))
    with pytest.raises(
        BadInput, match=r'supports only the control law cascade, but sblimp uses velocity'
    ):
        build_flight(*sblimp, TABLE)
    vehicle, scenario, policy = build_vehicle_scenario_stack(ingredients())
    with pytest.raises(BadInput, match=r'not along a course; leave --device out'):
        build_flight(vehicle, scenario, replace(policy, course=lambda _: Setpoint(1, 0, 0)), TABLE)


LIT = ('scenario.goal.time_limit=0.5 s', *BRIEF[1:])
SIMULATED = """
    import sys
    from lta_flight.batch import fly
    from lta_flight.batch.batch_flight import build_flight
    from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
    from lta_config.parameter_override import parse_assignment
    from lta_config.topics import load_topic_table
    import numpy as np

    fly.BLOCK_THREADS = 2
    out, device, *changes = sys.argv[1:]
    base = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab').with_values(
        dict(map(parse_assignment, changes))
    )
    flights = [
        build_flight(
            *build_vehicle_scenario_stack(base.with_values({'mission.speed': speed})),
            load_topic_table(),
        )
        for speed in (0.3, 0.5)
    ]
    told = fly.fly_many(flights, [1, 2, 3], device, which=np.array([0, 1, 1]))
    np.save(out, told)
"""


@pytest.mark.long
@needs_cuda
def test_a_thread_of_a_gpu_flies_the_same_closed_loop(tmp_path):
    told = {}
    for device, simulated in (('cpu-batch', '0'), ('gpu', '1')):
        out = tmp_path / f'{device}.npy'
        script = [sys.executable, '-c', textwrap.dedent(SIMULATED), str(out), device, *LIT]
        path = os.pathsep.join(filter(None, sys.path))
        done = subprocess.run(
            script,
            env=os.environ | {'PYTHONPATH': path, 'NUMBA_ENABLE_CUDASIM': simulated},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        told[device] = np.load(out)
    assert set(told['gpu'][:, FIGURES.index('outcome')]) == {TIMEOUT}
    assert told['gpu'][:, FIGURES.index('path_length')].min() > 0.0
    np.testing.assert_allclose(told['gpu'], told['cpu-batch'], rtol=1e-12, atol=1e-12)
