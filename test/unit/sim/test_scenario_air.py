# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The air of a scenario: profiles, turbulence, gusts, walls and recorded winds."""

import math

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_model.scenario import load_scenario, Scenario
from lta_model.scenario_air import low_altitude_turbulence
from lta_model.state import QUATERNION, SURROUNDINGS, VELOCITY, WIND, WIND_RATE
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance
from lta_sim.scene_model import collect_scene_effects, load_wind_record, vehicle_reach
from lta_sim.wind_record import WindRecord
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

from . import flat_balloon as balloon
from .lamp_room import build, edited, fly, ROOM

FIELD = {
    'wind': '8 m/s',
    'towards': '180 deg',
    'roughness': '0.3 m',
}
ROUGH = {'intensity': '0.3 m/s', 'length': '2 m'}
GUST = {'wind': {'value': [0, 0.5, 0], 'unit': 'm/s'}, 'begin': '10 s', 'length': '1500 ms'}
SHEAR = {
    'origin': {'value': [0, 0, 1], 'unit': 'm'},
    'x': {'value': [0.1, 0.2, 0.3], 'unit': '1/s'},
    'y': {'value': [0.4, 0.5, 0.6], 'unit': '1/s'},
    'z': {'value': [0.7, 0.8], 'unit': '1/s'},
}


def scene(**changes):
    return Scenario.model_validate(edited(ROOM, changes))


def effects(vehicle='gtmab', **changes):
    return collect_scene_effects(load_vehicle(vehicle), scene(**changes))


def test_a_scenario_of_old_adds_nothing():
    assert effects() == {}
    assert scene().room.walls == 'open'


def test_wind_over_rough_ground_is_averaged_over_the_hull():
    given = effects(**{'air/profile': FIELD})['wind_profile']
    assert given == {
        'x': -8.0,
        'y': pytest.approx(0.0, abs=1e-14),
        'height': 10.0,
        'roughness': 0.3,
        'half_height': 0.2995,  # half of the thickness, 1.198 r
    }
    lower = effects(**{'air/profile': {**FIELD, 'height': '2 m', 'towards': '90 deg'}})
    assert lower['wind_profile']['y'] == 8.0
    assert lower['wind_profile']['height'] == 2.0
    assert effects('multirotor', **{'air/profile': FIELD})['wind_profile']['half_height'] == 0.0


def test_turbulence_by_numbers_and_by_the_standard():
    one = effects(**{'air/turbulence': ROUGH})['turbulence']
    assert one == dict.fromkeys(('along', 'across', 'up'), 0.3) | dict.fromkeys(
        ('along_length', 'across_length', 'up_length'), 2.0
    )
    each = {**ROUGH, 'intensity': {'value': [0.3, 0.2, 0.1], 'unit': 'm/s'}}
    three = effects(**{'air/turbulence': each})['turbulence']
    assert (three['along'], three['across'], three['up']) == (0.3, 0.2, 0.1)
    military = {'by': 'MIL-F-8785C', 'wind': '8 m/s', 'height': '10 m'}
    assert effects(**{'air/turbulence': military})['turbulence'] == low_altitude_turbulence(
        10.0, 8.0
    )


def test_sheared_turbulence_follows_profile_and_height():
    """8 m/s at 10 m over 0.3 m are 6.87 m/s at 20 ft and 5.29 m/s at 10 ft by the log law."""
    air = {'air/profile': FIELD, 'air/turbulence': {'by': 'MIL-F-8785C', 'sheared': True}}
    given = effects(**air)['turbulence']
    standard = low_altitude_turbulence(3.048, 8.0 * math.log(6.096 / 0.3) / math.log(10.0 / 0.3))
    assert given == pytest.approx(
        standard | {'mean': 8.0 * math.log(3.048 / 0.3) / math.log(10.0 / 0.3), 'height': 3.048}
    )
    assert given['up'] == pytest.approx(0.687, abs=5e-4)
    # Without a profile, in the uniform wind
    calm = effects(**{'air/turbulence': air['air/turbulence']})['turbulence']
    assert (calm['along'], calm['mean']) == (0.0, 0.0)
    air['air/turbulence'] = {**air['air/turbulence'], 'strength': {'value': 0.5, 'unit': '1'}}
    half = effects(**air)['turbulence']
    assert (half['up'], half['mean']) == (0.5 * given['up'], given['mean'])


def test_sheared_turbulence_follows_the_vector_sum_of_the_winds():
    """4 m/s at 10 m over 0.3 m are 2.645 m/s at 10 ft: uniform wind against it leaves 0.645."""
    share = math.log(3.048 / 0.3) / math.log(10.0 / 0.3)
    air = {'air/profile': {**FIELD, 'wind': '4 m/s'}}
    air['air/turbulence'] = {'by': 'MIL-F-8785C', 'sheared': True}
    for wind, mean in (
        ([2.0, 0.0, 0.0], 4.0 * share - 2.0),
        ([-2.0, 0.0, 0.0], 4.0 * share + 2.0),
        ([0.0, 2.0, 5.0], math.hypot(4.0 * share, 2.0)),
    ):
        given = effects(**air, **{'air/wind': {'value': wind, 'unit': 'm/s'}})
        assert given['turbulence']['mean'] == pytest.approx(mean)


def test_sheared_turbulence_needs_wind_at_ten_feet():
    sheared = {'by': 'MIL-F-8785C', 'sheared': True}
    bushes = {'air/profile': {**FIELD, 'roughness': '3 m'}, 'air/turbulence': sheared}
    assert effects(**bushes)['turbulence']['mean'] > 0.0
    trees = {'air/profile': {**FIELD, 'roughness': '3.048 m'}}
    off = sheared | {'strength': {'value': 0, 'unit': '1'}}
    assert 'turbulence' not in effects(**trees, **{'air/turbulence': off})
    with pytest.raises(
        ValueError, match=r'over a roughness length of 3\.048 m, but the mean wind'
    ):
        effects(**trees, **{'air/turbulence': sheared})


def test_gust_and_gradient():
    given = effects(**{'air/gust': GUST, 'air/gradient': SHEAR})
    assert given['gusts'] == {
        'x': 0.0, 'y': 0.5, 'z': 0.0, 'begin': 10.0, 'length': 1.5, 'hold': 0.0,
    }  # fmt: skip
    assert given['wind_gradient'] == {
        'x': 0.0, 'y': 0.0, 'z': 1.0, 'x_x': 0.1, 'x_y': 0.2, 'x_z': 0.3,
        'y_x': 0.4, 'y_y': 0.5, 'y_z': 0.6, 'z_x': 0.7, 'z_y': 0.8,
    }  # fmt: skip


def test_walls_are_those_of_the_room_and_meet_the_hull():
    given = effects(**{'room/walls': 'solid'})['walls']
    assert (given['x_low'], given['x_high']) == (-5.0, 5.0)
    assert (given['y_low'], given['y_high'], given['ceiling']) == (-4.0, 4.0, 3.0)
    assert (given['radius'], given['half_height']) == (0.5, 0.2995)


def test_how_far_vehicles_reach():
    assert vehicle_reach(load_vehicle('skye')) == (1.35, 1.35)
    # A cigar along x counts as the round hull about it: half its length.
    hull = load_vehicle('rgblimp').file.hull
    assert vehicle_reach(load_vehicle('rgblimp')) == (hull.length.si / 2, hull.diameter.si / 2)
    radius, height = vehicle_reach(load_vehicle('multirotor'))
    assert 0.04 < radius < 0.08  # rotors 46 mm from the centre
    assert 0.005 < height < 0.05


def test_what_vehicle_and_scene_both_say_is_refused():
    vehicle = load_vehicle('gtmab')
    quantities = {
        'x': Quantity(value=1.0, unit='m/s', source='test'),
        'roughness': Quantity(value=0.1, unit='m', source='test'),
    }
    effect = {'wind_profile': quantities}
    both = type(vehicle)(vehicle.file.model_copy(update={'effects': effect}))
    with pytest.raises(
        BadInput, match='set both by the wind of the scenario lamp_room and by the veh'
    ):
        collect_scene_effects(both, scene(**{'air/profile': FIELD}))


def file(tmp_path, text):
    path = tmp_path / 'wind.csv'
    path.write_text(text)
    return path


def series(tmp_path, rows, head='t,u,v,w\n'):
    return file(tmp_path, head + ''.join(','.join(map(str, row)) + '\n' for row in rows))


ROWS = [(100.0, 0.0, 0.0, 0.0), (101.0, 1.0, -0.5, 0.2), (102.5, 1.0, 1.0, 0.0), (104, 0, 0, 0)]


def test_it_begins_with_the_flight_and_is_interpolated(tmp_path):
    record = WindRecord.read(series(tmp_path, ROWS), 4.0)
    assert record.time.tolist() == [0.0, 1.0, 2.5, 4.0]
    wind, rate = record.average_wind_over_span(0.4, 0.6)
    np.testing.assert_allclose(wind, (0.5, -0.25, 0.1), rtol=1e-15)
    np.testing.assert_allclose(rate, (1.0, -0.5, 0.2), rtol=1e-12)
    wind, rate = record.average_wind_over_span(0.9, 1.1)  # over a corner: the mean rate
    np.testing.assert_allclose(wind, (1.0, -0.5, 0.2))
    np.testing.assert_allclose(rate, (0.5, 0.25, (0.2 * (1 - 0.1 / 1.5) - 0.18) / 0.2))


def test_comments_and_empty_lines_are_passed_over(tmp_path):
    text = '# anemometer 3\n\nt,u,v,w\n0,1,0,0\n# a remark\n1,1,0,0\n'
    assert len(WindRecord.read(file(tmp_path, text), 1.0).time) == 2


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        ('time,u,v\n0,1,0\n', 'begins with "time,u,v" instead of the header "t,u,v,w";'),
        ('t,u,v,w\n0,1,0,0\n', 'has 1 rows below its header; at least two are needed.'),
        (
            't,u,v,w\n0,1,0,0\n1,nan,0,0\n',
            'has "1,nan,0,0" in line 3; the line must have four finite',
        ),
        ('t,u,v,w\n0,1,0,0\n1,,0,0\n', 'has "1,,0,0" in line 3; the line must have four finite'),
        ('t,u,v,w\n0,1,0\n', 'has "0,1,0" in line 2; the line must have four finite'),
        (
            't,u,v,w\n0,1,0,0\n1,-99,0,0\n',
            'has a wind of -99 m/s in line 3; at most 60 m/s are allowed.',
        ),
        ('t,u,v,w\n0,1,0,0\n2,1,0,0\n1,1,0,0\n', 'has t = 1 s after t = 2 s; sort its rows'),
        ('t,u,v,w\n0,1,0,0\n0,1,0,0\n', 'has t = 0 s after t = 0 s; sort its rows'),
        (
            't,u,v,w\n0,1,0,0\n1,1,0,0\n2,1,0,0\n3,1,0,0\n9,1,0,0\n',
            'has a gap of 6 s after t = 3 s, where rows are 1 s apart;',
        ),
        ('t,u,v,w\n0,1,0,0\n1,1,0,0\n', 'lasts 1 s, but the flight may take 5 s; give a longer'),
    ],
)
def test_what_is_wrong_with_a_file_is_one_sentence(tmp_path, text, sentence):
    with pytest.raises(BadInput) as caught:
        WindRecord.read(file(tmp_path, text), 5.0)
    assert sentence in str(caught.value)
    assert '\n' not in str(caught.value)


def test_bytes_that_are_no_text_and_no_file_at_all(tmp_path):
    path = tmp_path / 'wind.csv'
    path.write_bytes(b't,u,v,w\n\xff\xfe')
    with pytest.raises(BadInput, match='cannot be read'):
        WindRecord.read(path, 1.0)
    with pytest.raises(BadInput, match='cannot be read'):
        WindRecord.read(tmp_path / 'none.csv', 1.0)


def test_it_stands_beside_the_scenario(tmp_path, monkeypatch):
    series(tmp_path, [(t, 0.3, 0.0, 0.0) for t in range(61)])
    content = edited(ROOM, {'air/recorded': 'wind.csv'})
    (tmp_path / 'scene.yaml').write_text(yaml.safe_dump(content))
    scenario = load_scenario(str(tmp_path / 'scene.yaml'))
    assert scenario.wind_file == tmp_path / 'wind.csv'
    assert load_wind_record(scenario).average_wind_over_span(0.0, 0.01)[0][0] == 0.3
    monkeypatch.chdir(tmp_path.parent)
    assert load_scenario(f'{tmp_path.name}/scene.yaml').wind_file == tmp_path / 'wind.csv'


def test_a_steady_record_is_a_steady_wind_to_the_bit(tmp_path):
    path = series(tmp_path, [(t, 0.4, -0.2, 0.1) for t in range(0, 61, 10)])
    one = build(scene={'air/recorded': str(path)})
    two = build(scene={'air/wind': {'value': [0.4, -0.2, 0.1], 'unit': 'm/s'}})
    fly(one, 100, (0.3, 0.3, 0.2, 0.1))
    fly(two, 100, (0.3, 0.3, 0.2, 0.1))
    np.testing.assert_array_equal(one.state, two.state)
    assert one.wind == two.wind == pytest.approx((0.4, -0.2, 0.1))


def test_a_record_adds_to_the_steady_wind_and_moves_the_hull(tmp_path):
    path = series(tmp_path, [(t, 0.01 * t, 0.0, 0.0) for t in range(61)])
    steady = {'value': [0.0, 0.2, 0.0], 'unit': 'm/s'}
    world = build(scene={'air/recorded': str(path), 'air/wind': steady})
    calm = build()
    fly(world, 1000, (0.5, 0.5, 0.0, 0.0))
    fly(calm, 1000, (0.5, 0.5, 0.0, 0.0))
    # The period that begins at 10 s has the wind of 10.005 s.
    assert world.wind == pytest.approx((0.10005, 0.2, 0.0), rel=1e-12)
    assert world.state[0] - calm.state[0] > 0.02
    assert world.state[1] - calm.state[1] > 0.1


def test_an_inviscid_neutral_balloon_goes_with_the_recorded_air_exactly(tmp_path):
    """Displaced and added mass alike are pushed by the pressure gradient of dU/dt."""
    record = WindRecord.read(series(tmp_path, ROWS), 4.0)
    model = balloon.model(balloon.NEUTRAL | balloon.ADDED, (0.0, 0.0, 0.0), displaced=balloon.MASS)
    state, around = balloon.at(), np.zeros(SURROUNDINGS)
    for k in range(400):
        wind, rate = record.average_wind_over_span(k * 0.01, (k + 1) * 0.01)
        around[WIND : WIND + 3], around[WIND_RATE : WIND_RATE + 3] = wind, rate
        state = advance(state, model, np.zeros(4), around, 0.005, 2)
        now = [np.interp((k + 1) * 0.01, record.time, axis) for axis in record.wind.T]
        # Within a period the held wind is up to 5 mm/s beside that of the hull: enough for a
        # Munk moment that turns a flat hull by a little.
        flown = Rotation.from_quat(state[QUATERNION]).apply(state[VELOCITY])
        np.testing.assert_allclose(flown, now, atol=1e-7)
