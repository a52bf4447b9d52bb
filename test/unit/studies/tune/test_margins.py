# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Margins of loops with a closed form, and of a drone's own loop against its flight."""

from dataclasses import replace
import math

from lta_config.files import find_file, load_yaml
from lta_config.topics import load_topic_table
from lta_control.autopilot import Autopilot, build_drone_constants
from lta_control.estimator import EstimatorSettings
from lta_control.laws import load_gains
from lta_control.motion import Setpoint
from lta_model.sensors.pressure import PressureErrors, PressureSettings
from lta_model.sensors.range import RangeErrors, RangeSettings
from lta_sim.world import World
from lta_studies.tune.cma_search import replace_parameters
from lta_studies.tune.loop_cut import linearize_loop, LoopCut
from lta_studies.tune.margins import compute_loop_margins, compute_margins, to_decibels
from lta_studies.tune.step_response import TuningScene
import numpy as np
import pytest
import yaml

W = np.geomspace(1e-3, 1e3, 20000)
S = 1j * W
PERIOD = 0.01
LOSS = 6e-3  # kg; heavy enough that the vertical rotors stay away from standstill


def test_three_lags():
    # Routh: s^3 + 3 s^2 + 2 s + K is stable up to K = 6, and swings there at sqrt(2).
    found = compute_margins(W, 2.0 / (S * (S + 1.0) * (S + 2.0)))
    assert found.gain == pytest.approx(3.0, rel=1e-4)
    assert found.oscillation == pytest.approx(math.sqrt(2.0), rel=1e-4)
    assert found.gain_down is None


def test_an_integrator_with_a_delay():
    gain, delay = 2.0, 0.3
    found = compute_margins(W, gain / S * np.exp(-S * delay))
    assert found.crossover == pytest.approx(gain, rel=1e-6)
    assert found.phase == pytest.approx(0.5 * math.pi - gain * delay, rel=1e-5)
    assert found.gain == pytest.approx(math.pi / (2.0 * gain * delay), rel=1e-4)
    assert found.delay == pytest.approx((0.5 * math.pi - gain * delay) / gain, rel=1e-5)


def test_a_loop_that_too_little_gain_makes_swing():
    # Routh: s^3 + K s^2 + 2 K s + K is stable from K = 1/2 on.
    found = compute_margins(W, 2.0 * (S + 1.0) ** 2 / S**3)
    assert found.gain_down == pytest.approx(0.25, rel=1e-4)
    assert found.gain is None


def test_the_peak_of_a_double_integrator():
    # L = (2 d s + 1) / s^2: S = s^2 / (s^2 + 2 d s + 1); for d = 1/2, |S|^2 = x^2 / (x^2 - x + 1),
    # x = w^2, is largest at x = 2: 4/3.
    found = compute_margins(W, (S + 1.0) / S**2)
    assert found.peak == pytest.approx(math.sqrt(4.0 / 3.0), rel=1e-6)


def test_decibels():
    assert to_decibels(10.0) == pytest.approx(20.0)


@pytest.fixture(scope='module')
def delayed(tmp_path_factory):
    """Return GT-MAB with commands that take 105 ms: enough that gain alone can make it swing."""
    content = load_yaml(find_file('vehicle', 'gtmab'))
    delay = {'value': 105, 'unit': 'ms', 'source': 'this test'}
    content['effects']['command_delay'] = {'delay': delay}
    path = tmp_path_factory.mktemp('delayed') / 'delayed.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    return TuningScene(str(path))


def quiet(scene, loss):
    """Return a world whose sensors are true, at the rates that they have."""
    world = World(scene.build_true_vehicle(loss), scene.scenario, load_topic_table(), 1)
    errors = {'gain': (1.0,) * 6, 'offset': (0.0,) * 6, 'noise': (0.0,) * 6, 'step': (1e-9,) * 6}
    world.imu_errors = replace(world.imu_errors, **errors)
    world.range_settings, world._range = RangeSettings(noise=0.0), RangeErrors(0.0)
    world.pressure_settings = PressureSettings(noise=0.0, resolution=0.001)
    world._pressure = PressureErrors(0.0, 0.0)
    return world


def heave(scene, gains, loss, end):
    """Return the vertical speed of a hover that is kicked at 15 s [m/s]."""
    world = quiet(scene, loss)
    autopilot = Autopilot(
        build_drone_constants(scene.nominal_vehicle, EstimatorSettings(), gains, PERIOD)
    )
    told = []
    for tick in range(round(end / PERIOD)):
        if tick == 250:
            autopilot.set_setpoint(Setpoint(0.8, 0.0, 0.0))
        readings = world.sense_motion()
        distance = readings.ranges[-1][1] if readings.ranges else math.nan
        pressure = math.nan if readings.pressure is None else readings.pressure
        finite = distance if math.isfinite(distance) else math.nan
        duties = autopilot.step(readings.rates, readings.force, finite, pressure)
        if tick == 1500:
            world.state[9] += 0.02
        world.advance(duties)
        told.append(world.state[9])
    return np.array(told)


def test_the_gain_margin_is_where_the_flight_begins_to_swing(delayed):
    gains = load_gains('gtmab')
    rows = compute_loop_margins(delayed, gains, [LOSS], [0.0])
    found = next(row.margins for row in rows if row.loop == 'altitude')
    period = round(2.0 * math.pi / found.oscillation / PERIOD)

    def swing(share):
        factor = share * found.gain
        turned = {
            'climb.kp': factor * gains.climb.kp,
            'climb.ki': factor * gains.climb.ki,
            'climb.limit': 100.0,
        }
        speed = heave(delayed, replace_parameters(gains, turned), LOSS, 28.0)
        slow = np.convolve(speed, np.ones(period) / period, 'same')
        return (speed - slow)[2400:2700]

    below, above = swing(0.95), swing(1.05)
    assert below.std() < 3e-3 < 6e-3 < above.std()
    crossings = np.count_nonzero(np.diff(np.sign(above)) != 0)
    assert math.pi * crossings / 3.0 == pytest.approx(found.oscillation, rel=0.15)


@pytest.mark.long
def test_the_swing_that_the_linear_loop_foretells_grows_in_flight(delayed):
    """The hull hangs in the speed loop like a pendulum, which swings up unless it is stopped."""
    del delayed
    scene = TuningScene('gtmab')
    setpoint = Setpoint(1.0, 0.0, 0.4)
    shipped = load_gains('gtmab')
    assert linearize_loop(
        LoopCut(scene.build_true_vehicle(0.0), scene.nominal_vehicle, shipped), setpoint
    ).is_stable
    cut = LoopCut(
        scene.build_true_vehicle(0.0),
        scene.nominal_vehicle,
        replace_parameters(shipped, {'swing_gain': 0.0}),
    )
    linear = linearize_loop(cut, setpoint)
    assert not linear.is_stable
    state, memory = cut.find_steady_flight(setpoint)
    pitch = []
    past = np.tile(np.array(memory.pilot.law.command.duties), (cut.ages, 1))
    state[11] += 1e-4  # rad/s; far below where the drag is quadratic
    for _ in range(4000):
        memory, _ = cut.step_controller(state, memory, past, None)
        past = np.vstack([np.array(memory.pilot.law.command.duties), past[:-1]])
        state = cut.advance_vehicle(state, past)
        pitch.append(state[11])
    sizes = [np.std(pitch[begin : begin + 1000]) for begin in (2000, 3000)]
    assert math.log(sizes[1] / sizes[0]) / 10.0 == pytest.approx(linear.growth_rate, rel=0.1)
