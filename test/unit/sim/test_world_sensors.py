# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the world lets be sensed: where the sensors sit, on time, and each by its own chance."""

import itertools
import math

from lta_model.sensors.photodiode_adc import PhotodiodeBoard
from lta_sim.kernels import kernel
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from .lamp_room import build, fly, G, HOVER, START, STEP


@pytest.fixture(scope='module')
def rested():
    """A world that stood for 4 s, and all its readings."""
    world = build(seed=3)
    return world, fly(world, 400)


def test_at_rest_the_accelerometer_feels_gravity_upwards(rested):
    _, readings = rested
    force = np.mean([r.force for r in readings], axis=0)
    rates = np.mean([r.rates for r in readings], axis=0)
    # Data sheet: offsets up to 20 mg and 1 deg/s, scale errors up to 1 %.
    assert force[2] == pytest.approx(G, abs=0.02 * G + 0.01 * G)
    np.testing.assert_allclose(force[:2], 0.0, atol=0.02 * G)
    np.testing.assert_allclose(rates, 0.0, atol=math.radians(1.0))
    # What is left is noise of 160 to 190 ug/sqrt(Hz) in 40 Hz, 0.014 deg/s/sqrt(Hz) in 32 Hz.
    sigma = np.std([r.force for r in readings], axis=0)
    expected = np.array([160e-6, 160e-6, 190e-6]) * G * math.sqrt(40.0)
    np.testing.assert_allclose(sigma, expected, rtol=0.2)
    sigma = np.std([r.rates for r in readings], axis=0)
    np.testing.assert_allclose(sigma, math.radians(0.014) * math.sqrt(32.0), rtol=0.2)


def test_at_rest_the_range_is_that_of_the_gear():
    """The sensor hangs 37 cm below the centre: 0.41902 - 0.37 m, and an offset up to 20 mm."""
    offsets = {seed: build(seed)._range.offset for seed in range(20)}
    far, near = max(offsets, key=offsets.get), min(offsets, key=offsets.get)
    told = [x for r in fly(build(far), 400) for _, x in r.ranges]
    assert np.mean(told) == pytest.approx(0.04902 + offsets[far], abs=5e-4)
    assert np.std(told) == pytest.approx(0.0025, rel=0.2)
    # Below 4 cm the sensor says -Inf, as REP-117 wants.
    assert all(x == -math.inf for r in fly(build(near), 20) for _, x in r.ranges)


def test_at_rest_the_pressure_is_that_of_the_floor(rested):
    world, readings = rested
    told = [r.pressure for r in readings if r.pressure is not None]
    # The sensor sits 0.36 m below the centre: 101325 - 1.225 (of the standard) * g * 0.059,
    # with an offset up to 8 Pa and a drift up to 0.006 Pa/s.
    expected = 101325.0 - 1.225 * G * (0.41902 - 0.36)
    assert abs(world._pressure.offset) <= 8.0
    assert np.mean(told) - world._pressure.offset == pytest.approx(expected, abs=0.35)
    assert np.std(told) == pytest.approx(1.2, rel=0.2)


def test_the_barometer_drifts_with_the_time():
    seed = max(range(20), key=lambda seed: build(seed)._pressure.drift)
    early, late = build(seed), build(seed)
    late._enter_step(60_000)
    drift = late._pressure.drift
    assert late.sense().pressure - early.sense().pressure == pytest.approx(600 * drift, abs=0.7)
    assert 600 * drift > 2.0


def test_the_imu_feels_the_thrust_where_it_sits():
    """Both forward rotors at full: v' + w' x r at the IMU, 36 cm below the hull centre."""
    pushed, still = build(seed=6), build(seed=6)
    for world in pushed, still:
        world.state[2] = 1.0
    lag = SIM_LAYOUT.remembers['motor_lag']
    pushed.state[lag + 2 : lag + 4] = 1.0
    pushed.command[2:4] = 1.0
    rate = kernel.state_derivative(pushed.state, pushed.vehicle.build_model(), pushed.command)
    felt = rate[7:10] + np.cross(rate[10:13], (0.0, 0.0, -0.36))
    assert felt[0] > 0.5
    idle = kernel.state_derivative(still.state, still.vehicle.build_model(), still.command)
    told = np.subtract(pushed.sense().force, still.sense().force)  # the same noise and bias
    np.testing.assert_allclose(told, felt - idle[7:10], rtol=0.011, atol=0.004)


def test_every_25_ms_there_is_a_range_even_between_control_steps(rested):
    _, readings = rested
    stamps = [stamp for r in readings for stamp, _ in r.ranges]
    assert stamps == [START + k * 25_000_000 for k in range(160)]
    for r in readings:
        assert all(r.stamp_ns - STEP < stamp <= r.stamp_ns for stamp, _ in r.ranges)


def test_stamps_are_the_control_steps(rested):
    _, readings = rested
    assert [r.stamp_ns for r in readings] == [START + k * STEP for k in range(400)]
    assert [r.stamp_ns for r in readings if r.pressure is not None] == [
        START + k * 20_000_000 for k in range(200)
    ]
    assert all(len(r.truth) == 13 for r in readings)  # the instant of arrival must be in the bag
    for what in ('battery', 'panel', 'illuminance'):
        due = [r.stamp_ns for r in readings if getattr(r, what) is not None]
        assert due == [START + k * 100_000_000 for k in range(40)]


def test_a_light_block_comes_after_its_last_sample_with_the_stamp_of_its_first(rested):
    _, readings = rested
    blocks = [(r.stamp_ns, *r.block) for r in readings if r.block is not None]
    assert [came for came, _, _ in blocks] == [START + k * 100_000_000 for k in range(1, 40)]
    for came, begun, samples in blocks:
        assert begun == came - 100_000_000
        assert samples.shape == (1000, 8)
        assert samples.dtype == np.uint16


def test_the_lamp_is_in_the_light(rested):
    """At 150 Hz, bin 15 of 10 Hz, the diode that faces the lamp has most."""
    world, readings = rested
    block = next(r.block[1] for r in readings if r.block is not None).astype(float)
    bins = np.abs(np.fft.rfft(block, axis=0))[15]
    z, w = world.state[5:7]
    heading = 2 * math.atan2(z, w)
    azimuths = 2 * math.pi * np.arange(8) / 8
    assert np.argmax(bins) == np.argmax(np.cos(azimuths + heading))


def test_amplifiers_and_poses_go_on_from_block_to_block(monkeypatch):
    world = build(seed=5)
    calls, own = [], PhotodiodeBoard.sample_block

    def spy(board, light, start, generator, state):
        block, after = own(board, light, start, generator, state)
        calls.append((light.modulated, state, after))
        return block, after

    monkeypatch.setattr(PhotodiodeBoard, 'sample_block', spy)
    fly(world, 41, (0.3, 0.3, 0.5, 0.2))
    assert len(calls) == 4
    assert calls[0][1] is None
    for (light, _, after), (next_light, before, _) in itertools.pairwise(calls):
        assert before is after
        assert light.shape == next_light.shape == (1, 11, 8)  # both ends of ten control steps
        np.testing.assert_array_equal(next_light[:, 0], light[:, -1])
    assert not np.array_equal(calls[-1][0][:, 0], calls[-1][0][:, -1])


def everything(readings):
    out = []
    for r in readings:
        out += [*r.force, *r.rates, r.pressure or 0.0, r.illuminance or 0.0]
        out += [x for pair in r.ranges for x in pair]
        out += [*(r.battery or ()), *(r.panel or ())]
        if r.block is not None:
            out += r.block[1].ravel().tolist()
    return np.array(out)


def test_the_same_seed_gives_the_same_world():
    a, b = build(seed=9), build(seed=9)
    np.testing.assert_array_equal(everything(fly(a, 45, HOVER)), everything(fly(b, 45, HOVER)))
    np.testing.assert_array_equal(a.state, b.state)
    assert a.charge == b.charge


def test_another_seed_gives_another():
    a, b = build(seed=9), build(seed=10)
    assert not np.array_equal(a.state[3:7], b.state[3:7])
    a, b = fly(a, 1)[0], fly(b, 1)[0]
    for what in ('force', 'rates', 'pressure', 'battery'):
        assert getattr(a, what) != getattr(b, what)


@pytest.mark.parametrize(
    ('topic', 'same', 'other'),
    [
        ('pressure', ('force', 'rates', 'ranges', 'battery', 'panel', 'light'), 'pressure'),
        ('range', ('force', 'rates', 'pressure', 'battery', 'panel', 'light'), 'ranges'),
    ],
)
def test_one_sensor_more_often_leaves_the_noise_of_the_others(topic, same, other):
    """Each has its own stream of chance."""

    def told(world):
        readings = fly(world, 41)
        return {
            'force': [r.force for r in readings],
            'rates': [r.rates for r in readings],
            'ranges': [pair for r in readings for pair in r.ranges],
            'pressure': [r.pressure for r in readings],
            'battery': [r.battery for r in readings],
            'panel': [r.panel for r in readings],
            'light': [r.block[1].tolist() for r in readings if r.block is not None],
        }

    a = told(build(seed=4))
    # The range between control steps cuts the integration elsewhere; 50 ms is on both grids.
    b = told(build(seed=4, topics={f'topics/{topic}/period': '50 ms'}))
    assert a[other] != b[other]
    for name in same:
        assert a[name] == b[name], name
