# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The air and the walls of a scenario: what they come to for a vehicle, and what is refused."""

import math

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.quantity import Quantity
from lta_model.scenario import load_scenario, Scenario
from lta_model.scenario_air import low_altitude_turbulence
from lta_model.vehicle import load_vehicle
from lta_sim.scene_model import collect_scene_effects, vehicle_reach
import pytest

from .lamp_room import edited, ROOM

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


@pytest.mark.parametrize('name', list_shipped_names('scenarios'))
def test_every_shipped_scenario_can_be_flown_in(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    vehicle = load_vehicle('gtmab', scenario.air.density)
    vehicle.build_model(collect_scene_effects(vehicle, scenario))


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


@pytest.mark.parametrize('form', [ROUGH, {'by': 'MIL-F-8785C', 'wind': '8 m/s', 'height': '10 m'}])
def test_strength_multiplies_the_rms_alone(form):
    def given(strength):
        value = {'value': strength, 'unit': '1'}
        return effects(**{'air/turbulence': {**form, 'strength': value}})

    full, half = given(1.0)['turbulence'], given(0.5)['turbulence']
    for axis in ('along', 'across', 'up'):
        assert half[axis] == 0.5 * full[axis] > 0.0
        assert half[f'{axis}_length'] == full[f'{axis}_length']
    assert given(0.0) == {}


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
