"""The world: at rest on the floor, on time, reproducible, and honest about energy and ends."""

import copy
import itertools
import math

from lta_config.files import find, load_yaml, share
from lta_config.topics import TopicTable
from lta_config.vehicle_file import VehicleFile
from lta_energy.battery import open_circuit_voltage
from lta_sim import kernel
from lta_sim.readings import Outcome
from lta_sim.scenario import Scenario
from lta_sim.sensors.light_block import synthesise
from lta_sim.vehicle import Vehicle
from lta_sim.world import World
import numpy as np
import pytest

G = 9.80665
OFF = (0.0, 0.0, 0.0, 0.0)
HOVER = (0.12844, 0.12844, 0.0, 0.0)
TOPICS = load_yaml(share() / 'topics.yaml')
ROOM = load_yaml(find('scenario', 'lamp_room'))
GTMAB = load_yaml(find('vehicle', 'gtmab'))
START = 1_000_000_000
STEP = 10_000_000


def edited(content, changes):
    content = copy.deepcopy(content)
    for place, value in changes.items():
        *way, last = place.split('/')
        part = content
        for key in way:
            part = part[key]
        part[last] = value
    return content


def build(seed=1, scene=None, topics=None, vehicle=None):
    scenario = Scenario.model_validate(edited(ROOM, scene or {}))
    file = VehicleFile.model_validate(edited(GTMAB, vehicle or {}))
    table = TopicTable.model_validate(edited(TOPICS, topics or {}))
    return World(Vehicle(file, scenario.air.density), scenario, table, seed)


def fly(world, steps, duties=OFF):
    """Return the readings of so many control steps."""
    out = []
    for _ in range(steps):
        out.append(world.sense())
        world.advance(duties)
    return out


@pytest.fixture(scope='module')
def rested():
    """A world that stood for 4 s, and all its readings."""
    world = build(seed=3)
    return world, fly(world, 400)


def test_it_stands_still_before_take_off(rested):
    world, _ = rested
    x, y, z = world.state[:3]
    assert (x, y) == pytest.approx((-3.5, 0.0), abs=1e-9)
    assert z == pytest.approx(0.42 - 0.002 * G / 20.0, abs=1e-9)
    np.testing.assert_allclose(world.state[7:13], 0.0, atol=1e-9)
    assert world.outcome is Outcome.FLYING
    assert world.elapsed == pytest.approx(4.0)
    assert world.distance == pytest.approx(7.0)


def test_the_start_is_drawn_within_the_spread():
    scene = {'start/heading': '30 deg', 'start/heading_spread': '10 deg'}
    headings = []
    for seed in range(40):
        z, w = build(seed, scene).state[5:7]
        headings.append(math.degrees(2 * math.atan2(z, w)))
    assert 20.0 < min(headings) < 22.0
    assert 38.0 < max(headings) < 40.0


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


def test_the_barometer_sits_with_the_imu():
    """Five metres up the standard atmosphere is 5 * 1.225 * g = 60 Pa thinner."""
    place = {'value': [0, 0, 4.64], 'unit': 'm', 'source': 'test'}
    low, high = build(seed=3), build(seed=3, vehicle={'sensors/imu_position': place})
    fall = low.sense().pressure - high.sense().pressure
    assert fall == pytest.approx(5.0 * 1.225 * G, abs=0.7)  # two roundings to 0.33 Pa


def test_the_barometer_drifts_with_the_time():
    seed = max(range(20), key=lambda seed: build(seed)._pressure.drift)
    early, late = build(seed), build(seed)
    late.steps = 60_000
    drift = late._pressure.drift
    assert late.sense().pressure - early.sense().pressure == pytest.approx(600 * drift, abs=0.7)
    assert 600 * drift > 2.0


def test_a_tilted_range_is_the_slant():
    world, roll = build(), 0.5
    world.state[2] = 1.0
    world.state[3:7] = math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)
    (_, told), *_ = world.sense().ranges
    slant = 1.0 / math.cos(roll) - 0.37
    assert told == pytest.approx(slant + world._range.offset, abs=4 * 0.0025)


def test_the_imu_feels_the_thrust_where_it_sits():
    """Both forward rotors at full: v' + w' x r at the IMU, 36 cm below the hull centre."""
    pushed, still = build(seed=6), build(seed=6)
    for world in pushed, still:
        world.state[2] = 1.0
    pushed.state[15:17] = 1.0
    pushed.duties = np.array([0.0, 0.0, 1.0, 1.0])
    rate = kernel.derivative(pushed.state, pushed.vehicle.model(), pushed.duties)
    felt = rate[7:10] + np.cross(rate[10:13], (0.0, 0.0, -0.36))
    assert felt[0] > 0.5
    idle = kernel.derivative(still.state, still.vehicle.model(), still.duties)
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
    assert all(r.truth for r in readings)  # the instant of arrival must be in the bag
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
    calls = []

    def spy(array, field, light, *rest):
        block, after = synthesise(array, field, light, *rest)
        calls.append((light.modulated, rest[-1], after))
        return block, after

    monkeypatch.setattr('lta_sim.world.synthesise', spy)
    fly(build(seed=5), 41, (0.3, 0.3, 0.5, 0.2))
    assert len(calls) == 4
    assert calls[0][1] is None
    for (light, _, after), (next_light, before, _) in itertools.pairwise(calls):
        assert before is after
        assert light.shape == next_light.shape == (11, 8)  # both ends of ten control steps
        np.testing.assert_array_equal(next_light[0], light[-1])
    assert not np.array_equal(calls[-1][0][0], calls[-1][0][-1])


def consumed(duty, steps):
    world = build(seed=2, scene={'ambient/steady': '0 lx', 'ambient/mains_amplitude': '0 lx'})
    fly(world, 100, (duty,) * 4)  # the motors have reached their duty: 14 time constants
    before = world.charge
    fly(world, steps, (duty,) * 4)
    return world, before - world.charge


@pytest.mark.parametrize('duty', [0.0, 0.5])
def test_the_battery_drains_by_what_the_loads_draw(duty):
    world, used = consumed(duty, 500)
    # By hand: 97 + 23 mW, and of each turning rotor 27 mW + 23.96 W/N of 0.0915 u^2 + 0.0677 u.
    thrust = 0.0915 * duty**2 + 0.0677 * duty
    power = 0.120 + 4 * (0.027 + 23.96 * thrust) * (duty > 0)
    harvest = 0.2 * 0.013884 * world.sense().illuminance / 300.0
    assert harvest < 0.01 * power
    resting = open_circuit_voltage(world.charge)
    # (E - 0.15 I) I = P for 5 s of 900 C.
    current = (resting - math.sqrt(resting**2 - 4 * 0.15 * (power - harvest))) / (2 * 0.15)
    assert used == pytest.approx(current * 5.0 / 900.0, rel=2e-3)
    voltage, metered = world.sense().battery
    assert metered == pytest.approx(-current, abs=0.002 * current + 4e-4 + 3e-4)
    assert voltage == pytest.approx(resting - 0.15 * current, rel=0.004)


def test_light_on_the_panel_charges():
    bright = build(seed=2, scene={'ambient/steady': '100000 lx'})
    before = bright.charge
    readings = fly(bright, 200)
    # 100 klx / 300 lm/W * 0.013884 m2 * 20 % = 0.93 W, less 0.12 W drawn.
    lux = readings[10].illuminance
    assert lux == pytest.approx(1e5, rel=0.05)
    harvest = lux / 300.0 * 0.013884 * 0.2
    assert readings[10].panel[1] == pytest.approx(harvest / 4.4, abs=0.002)
    assert readings[10].panel[0] == pytest.approx(4.4, abs=0.02)
    gained = (harvest - 0.12) / (open_circuit_voltage(before) + 0.03) * 2.0 / 900.0
    assert bright.charge - before == pytest.approx(gained, rel=0.02)


def test_the_panel_gives_more_of_the_sun_than_of_leds():
    def harvest(efficacy):
        scene = {
            'lamp/flux': '0 lm',
            'ambient/steady': '50000 lx',
            'ambient/efficacy': efficacy,
        }
        return build(scene=scene)._harvest()

    # 50 klx / 105 lm/W * 0.013884 m2 * 20 %.
    assert harvest('105 lm/W') == pytest.approx(1.32229, rel=1e-5)
    assert harvest('105 lm/W') / harvest('300 lm/W') == pytest.approx(300 / 105, rel=1e-12)


def test_the_panel_looks_up():
    """Lambertian lamp, half of the time on, 0.2 m aside: 0.5 flux / pi cos^2 / distance^2."""
    scene = {
        'lamp/position': {'value': [-3.5, 0, 2.5], 'unit': 'm'},
        'lamp/facing': {'value': [0, 0, -1], 'unit': '1'},
        'ambient/steady': '0 lx',
        'ambient/mains_amplitude': '0 lx',
        'room/albedo': 0.0,
        'goal/radius': '0.1 m',
        'start/position': {'value': [-3.5, 0.2], 'unit': 'm'},
    }
    below = 2.5 - (0.41902 + 0.302)
    expected = 0.5 * 10000.0 / math.pi * below**2 / (below**2 + 0.2**2) ** 2
    assert build(scene=scene).sense().illuminance == pytest.approx(expected, rel=1e-4)
    scene |= {
        'lamp/position': {'value': [-3.5, 0, 0.1], 'unit': 'm'},
        'lamp/facing': {'value': [0, 0, 1], 'unit': '1'},
    }
    assert build(scene=scene).sense().illuminance == 0.0


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


def test_streams_differ_from_each_other():
    """Two meters of one kind on one seed must not make the same errors."""
    world = build(seed=4)
    assert world._meters['battery'] != world._meters['panel']


def arrive(x, y, z=0.5, steps=0):
    """Return the outcome of a drone that is put somewhere, one control period on."""
    world = build(scene={'goal/time_limit': '60 s'})
    world.state[:3] = x, y, z
    world.steps = steps
    world.advance(OFF)
    return world.outcome


def test_outcomes():
    assert arrive(2.49, 0.0) is Outcome.FLYING
    assert arrive(2.5001, 0.0) is Outcome.REACHED
    assert arrive(3.5, -1.01) is Outcome.FLYING
    assert arrive(3.5, 0.99, 2.9) is Outcome.REACHED  # horizontally
    assert arrive(4.99, 3.99) is Outcome.FLYING
    for lost in ((5.01, 3.0), (-5.01, 0.0), (0.0, 4.01), (0.0, -4.01), (0.0, 0.0, 3.01)):
        assert arrive(*lost) is Outcome.ESCAPED
    assert arrive(0.0, 0.0, steps=5998) is Outcome.FLYING
    assert arrive(0.0, 0.0, steps=5999) is Outcome.TIMEOUT
    assert arrive(3.0, 0.0, steps=5999) is Outcome.REACHED  # at the last moment


def test_an_outcome_stays():
    world = build()
    world.state[:3] = 3.0, 0.0, 0.5
    world.advance(OFF)
    world.state[:3] = 0.0, 0.0, 0.5
    world.advance(OFF)
    assert world.outcome is Outcome.REACHED


def test_rotors_that_do_not_reverse_never_push_backwards():
    world, still = build(), build()
    fly(world, 100, (-1.0,) * 4)
    fly(still, 100, OFF)
    np.testing.assert_array_equal(world.state, still.state)
    np.testing.assert_array_equal(world.duties, OFF)


def test_a_reversible_rotor_does():
    reversing = {f'rotors/{name}/reversible': True for name in GTMAB['rotors']}
    world = build(vehicle=reversing, scene={'start/heading_spread': '0 deg'})
    fly(world, 100, (0.3, 0.3, -1.0, -1.0))
    assert world.duties.tolist() == [0.3, 0.3, -1.0, -1.0]
    assert world.state[7] < -0.1


def test_duties_beyond_full_are_full():
    world, full = build(), build()
    fly(world, 50, (7.0, 7.0, 2.0, 2.0))
    fly(full, 50, (1.0,) * 4)
    np.testing.assert_array_equal(world.state, full.state)


@pytest.mark.parametrize(
    'duties', [(math.nan, 0, 0, 0), (0, 0, math.inf, 0), (0.1, 0.1, 0.1), (0.1,) * 5, ()]
)
def test_duties_that_mean_nothing_are_refused(duties):
    world = build()
    before = world.state.copy()
    with pytest.raises(ValueError, match=r'^The duties are .*; give 4 finite numbers\.$'):
        world.advance(duties)
    np.testing.assert_array_equal(world.state, before)
    assert world.steps == 0


def test_it_takes_off_and_flies_where_its_nose_points():
    world = build(scene={'start/heading': '0 deg', 'start/heading_spread': '0 deg'})
    fly(world, 400, (0.3, 0.3, 0.3, 0.3))
    assert world.state[2] > 0.6
    assert world.state[0] > -3.5 + 0.2
    assert abs(world.state[1]) < 1e-6


def test_wind_carries_it_and_never_faster_than_itself():
    scene = {
        'air/wind': {'value': [0.4, -0.2, 0.0], 'unit': 'm/s'},
        'start/position': {'value': [0, 0], 'unit': 'm'},
        'start/heading': f'{math.atan2(-0.2, 0.4)} rad',
        'start/heading_spread': '0 rad',
    }
    world = build(scene=scene)
    fly(world, 100, (0.35, 0.35, 0.0, 0.0))  # off the floor
    fly(world, 500, HOVER)
    x, y, z = world.state[:3]
    assert z > 0.45
    assert 0.1 < x < 0.4 * 6
    assert y / x == pytest.approx(-0.5, rel=0.05)


def test_the_wrenches_are_those_of_the_effects():
    world = build()
    given = world.wrenches()
    assert set(given) >= {'weight_and_buoyancy', 'quadratic_drag', 'rotor_thrust', 'floor_contact'}
    # At rest the floor carries the two grams.
    assert given['floor_contact'][2] == pytest.approx(0.002 * G, rel=1e-6)
    assert given['weight_and_buoyancy'][2] == pytest.approx(-0.002 * G, rel=1e-6)
