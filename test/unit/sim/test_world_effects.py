# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Measurement effects in the world: what is told and obeyed, against the undisturbed flight."""

import math

from lta_model.effects import EFFECTS
from lta_model.light.view import LightView
from lta_model.state import IRRADIANCE, NOISE, VOLTAGE
from lta_sim.command_link import CommandLink
from lta_sim.environment import FlightEnvironment
from lta_sim.kernels import kernel
from lta_sim.readings import SensorReadings
import numpy as np
import pytest

from .even_light import spread_evenly
from .lamp_room import build, fly
from .test_measurement_effects import EFFECTS as MEASURING

FLYING = (0.5, 0.4, 0.3, 0.2)


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    """Know the measurement effects, whether they are in the registry or not."""
    for name, effect in MEASURING.items():
        monkeypatch.setitem(EFFECTS, name, effect)


def given(effect, **parameters):
    """Return a change of the vehicle file that sets parameters of an effect."""
    units = {known.name: known.unit for known in EFFECTS[effect].parameters}
    block = {
        name: {'value': value, 'unit': units[name], 'source': 'test'}
        for name, value in parameters.items()
    }
    return {f'effects/{effect}': block}


def flown(steps=12, seed=3, **vehicle):
    """Return a world, all its readings and its state before each."""
    world, states, readings = build(seed=seed, **vehicle), [], []
    for _ in range(steps):
        states.append(tuple(world.state[:13].tolist()))
        readings += fly(world, 1, FLYING)
    return world, readings, states


def plain(reading: SensorReadings):
    """Return a reading as something that compares."""
    block = None if reading.block is None else reading.block[1].tobytes()
    return [getattr(reading, name) for name in SensorReadings.__slots__ if name != 'block'] + [
        block
    ]


def test_at_null_every_reading_stays_bit_for_bit():
    null = {}
    for name in (*MEASURING, 'command_delay'):
        null |= given(name, **{known.name: known.null for known in EFFECTS[name].parameters})
    _, readings, states = flown()
    _, same, states_too = flown(vehicle=null)
    assert states == states_too
    assert [plain(r) for r in readings] == [plain(r) for r in same]
    assert [r.truth for r in same] == states


def test_biases_reach_the_readings_and_nothing_else():
    change = given('imu_bias', x=0.5) | given('gyro_bias', z=-0.05)
    change |= given('pressure_drift', rate=0.5) | given('range_offset', offset=0.1)
    _, readings, states = flown(201)
    world, moved, states_too = flown(201, vehicle=change)
    assert states == states_too
    gain = world.imu_errors.gain
    for a, b in zip(readings, moved, strict=True):
        turned = np.subtract(b.rates, a.rates)
        pushed = np.subtract(b.force, a.force)
        # Counts are 1.8 mm/s2 and 0.27 mrad/s: two roundings.
        np.testing.assert_allclose(pushed, (0.5 * gain[0], 0, 0), atol=1.8e-3)
        np.testing.assert_allclose(turned, (0, 0, -0.05 * gain[5]), atol=2.7e-4)
        assert b.illuminance == a.illuminance
        assert b.battery == a.battery
    assert moved[200].pressure - readings[200].pressure == pytest.approx(0.5 * 2.0, abs=0.34)
    (_, near), (_, far) = readings[200].ranges[-1], moved[200].ranges[-1]
    assert far - near == pytest.approx(0.1, abs=1.1e-3)


def test_a_late_tracker_tells_what_was():
    _, readings, states = flown(vehicle=given('tracker_delay', delay=0.03))
    assert [r.truth for r in readings[3:]] == states[:-3]
    assert all(r.truth == states[0] for r in readings[:3])


def test_between_steps_a_late_tracker_interpolates():
    """25 ms lies midway between the steps 20 and 30 ms ago."""
    _, readings, states = flown(60, vehicle=given('tracker_delay', delay=0.025))
    middle = np.add(states[56], states[57]) / 2.0
    np.testing.assert_allclose(readings[59].truth, middle, rtol=0.0, atol=1e-7)
    # The flight itself between them, integrated.
    world, _, _ = flown(56)
    model, command = world.vehicle.build_model(), world.command
    truth = kernel.advance(world.state, model, command, world._around.numbers, 0.0025, 2)
    np.testing.assert_allclose(readings[59].truth, truth[:13], rtol=0.0, atol=3e-4 / 8)
    assert math.hypot(*readings[59].truth[3:7]) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize(
    ('offset', 'told', 'true', 'within'),
    [
        (-0.02, slice(2, None), slice(None, -2), 1e-12),
        # Under a constant command what is flown ahead is what comes.
        (0.02, slice(1, -2), slice(3, None), 1e-9),
    ],
    ids=['slow', 'fast'],
)
def test_a_clock_of_the_vehicle_that_is_off_is_a_tracker_behind_or_ahead(
    offset, told, true, within
):
    _, readings, states = flown(vehicle=given('clock_offset', offset=offset))
    for reading, state in zip(readings[told], states[true], strict=True):
        assert reading.truth == pytest.approx(state, abs=within)


def test_skew_grows_with_the_flight():
    """10 s at -1000 ppm are one control step."""
    _, readings, states = flown(1002, vehicle=given('clock_skew', skew=-1e-3))
    assert readings[1].truth == pytest.approx(states[1], abs=1e-4)
    # At 10.01 s it is 10.01 ms late.
    assert readings[1001].truth == pytest.approx(states[1000], abs=1e-4)
    assert abs(readings[1001].truth[0] - states[1001][0]) > 5e-4


@pytest.mark.parametrize('offset', [0.3, 0.0, -0.3])
def test_a_tracker_keeps_no_more_than_it_may_still_be_asked_for(offset):
    """Whichever clock is ahead: 10 min of it once kept each of the 60 000 steps."""
    world, _, _ = flown(400, vehicle=given('clock_offset', offset=offset))
    assert len(world._tracker._past) <= 33


def test_a_late_command_takes_over_when_it_arrives():
    """13 ms: the rotors stand still for one period and 3 ms, then obey."""
    world, _, _ = flown(2, vehicle=given('command_delay', delay=0.013))
    still = build(seed=3)
    model, around = still.vehicle.build_model(), still._around.numbers
    off, on = np.zeros(11), np.zeros(11)
    on[:4] = FLYING
    state = kernel.advance(still.state, model, off, around, 0.0025, 4)
    state = kernel.advance(state, model, off, around, 0.0015, 2)
    state = kernel.advance(state, model, on, around, 0.007 / 3, 3)
    np.testing.assert_array_equal(world.state, state)
    np.testing.assert_array_equal(world.duties, FLYING)


def test_commands_overtake_each_other_only_forwards():
    """As the delay shrinks, the latest command that has arrived is obeyed."""
    times = {0.0: -0.025, 0.01: -0.015, 0.02: 0.018, 0.03: 0.028}

    def slow(p, values, time):
        return (times[round(time, 3)],)

    link = CommandLink((True,), {}, ((slow, ()),))
    seen = []
    for k in range(4):
        command = link.pack_command((0.1 * (k + 1),))
        spans = link.send_command(k * 10**7, (k + 1) * 10**7, k * 0.01, command)
        seen.append([(until, round(float(told[0]), 3)) for until, told in spans])
    assert seen == [
        [(10_000_000, 0.0)],
        [(20_000_000, 0.0)],
        [(22_000_000, 0.2), (30_000_000, 0.3)],
        [(32_000_000, 0.3), (40_000_000, 0.4)],
    ]


def test_a_moving_mass_rests_where_it_was_weighed_until_told():
    link = CommandLink((False, True), {'moving_mass': {'x': 0.07, 'z': 0.2}}, ())
    assert link.idle[8:].tolist() == [0.07, 0.0, 0.2]
    assert link.pack_command((-0.5, -2.0)).tolist() == [0.0, -1.0, *[0.0] * 6, 0.07, 0.0, 0.2]
    assert link.pack_command((0.5, 0.5), (0.1, 0.0, 0.2))[8:].tolist() == [0.1, 0.0, 0.2]
    assert link.pack_command((0.5, 0.5))[8:].tolist() == [0.1, 0.0, 0.2]
    with pytest.raises(ValueError, match='must be 3 finite numbers'):
        link.pack_command((0.0, 0.0), (math.nan, 0.0, 0.0))


def test_a_sagging_battery_weakens_the_rotors():
    """T = 0.0915 u'^2 + 0.0677 u' at u' = u V / 4.2, V under load."""
    world, _, _ = flown(200, vehicle=given('battery_sag', voltage=4.2))
    volts = world._around.numbers[VOLTAGE]
    assert 3.9 < volts < 4.15
    around, model = world._around.numbers, world.vehicle.build_model()
    thrusts = kernel.evaluate_model(world.state, model, world.command, around).thrusts
    for thrust, duty in zip(thrusts, FLYING, strict=False):
        turning = duty * volts / 4.2
        assert thrust == pytest.approx(0.0915 * turning**2 + 0.0677 * turning, rel=1e-4)
    np.testing.assert_array_equal(thrusts[4:], 0.0)


def surrounded(effects, seed=1):
    world = build(scene={'air/wind': {'value': [0.4, -0.2, 0.1], 'unit': 'm/s'}})
    light = LightView(world.scenario.light_field, world.vehicle)
    chance = np.random.default_rng(seed)
    return FlightEnvironment(
        {name: {} for name in effects}, world.scenario, light, chance, 0.01, 0.5
    ), world


def test_turbulence_has_white_noise_of_unit_intensity():
    around, world = surrounded(('turbulence',))
    drawn = []
    for _ in range(4000):
        around.refresh(world._pose(), 3.9, 0.0)
        drawn.append(around.numbers[NOISE : NOISE + 3].copy())
    # Variance 1 / 10 ms; its estimate from 12000 draws is good to 1.3 %.
    assert np.var(drawn) == pytest.approx(100.0, rel=0.04)
    assert np.mean(drawn) == pytest.approx(0.0, abs=0.3)


def test_superheat_sees_the_lamp_whichever_way_the_hull_is_turned():
    around, world = surrounded(('superheat',))
    around.refresh(world._pose(), 3.9, 0.0)
    lamp, ambient, room = (
        world.scenario.light_field.__getattribute__(n) for n in ('first_lamp', 'ambient', 'room')
    )
    ray = np.subtract(world.state[:3], lamp.position)
    squared = float(ray @ ray)
    leaving = float(ray @ lamp.axis) / math.sqrt(squared) / math.hypot(*lamp.axis)
    lux = 10000.0 / math.pi * leaving / (squared + 0.015**2) + spread_evenly(10000.0, room)
    expected = 0.5 * lux / lamp.efficacy + ambient.steady / ambient.efficacy
    assert around.numbers[IRRADIANCE] == pytest.approx(expected, rel=1e-12)
