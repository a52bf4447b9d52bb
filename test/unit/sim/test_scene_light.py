# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Scenes in the sun and with a door: what saturates, warm gas, wind and bounds at the door."""

from lta_config.files import find_file, load_yaml
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import load_topic_table
from lta_model.light.view import LightView
from lta_model.scenario import load_scenario, Scenario
from lta_model.state import WIND
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.scene_model import collect_scene_effects
from lta_sim.termination import FlightTermination
from lta_sim.world import World
from lta_vlc.demodulation import demodulate_beacon, plan_bins
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest

from .lamp_room import edited

GTMAB = load_vehicle('gtmab')


def with_resistor(ohm, vehicle='gtmab'):
    content = load_yaml(find_file('vehicle', vehicle))
    feedback = {'value': ohm, 'unit': 'ohm', 'source': 'test'}
    file = VehicleFile.model_validate(edited(content, {'sensors/diodes/feedback': feedback}))
    return Vehicle(file)


@pytest.mark.parametrize(
    ('scene', 'ohm', 'heard'),
    [
        ('lamp_room', 1e5, True),
        ('sunny_field', 1e5, False),  # 10 klx from the grass; full scale is 2 klx
        ('sunny_field', 1e4, True),
        ('lamp_room', 1e4, True),
    ],
)
def test_the_resistor_is_the_vehicles_and_saturates_where_it_saturates(scene, ohm, heard):
    """SNR above 10 at seven metres in a room with mains, and at 80 klx."""
    vehicle = with_resistor(ohm)
    view = LightView(load_scenario(scene).light_field, vehicle)
    view.record_pose((-3.5, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0))
    block = view.sample_light_block(10**9, 1e4, 1000, np.random.default_rng(1))
    snr = demodulate_beacon(block, plan_bins(DemodulationSettings(), 1e4, 1000)).snr
    assert (snr.max() > 10.0) == heard
    assert (block.min() == 4095) == (not heard)
    assert vehicle.diodes.gain_scale == ohm / 1e5


def test_the_sunny_field_has_80_klx():
    assert load_scenario('sunny_field').light_field.daylight.ground_illuminance == pytest.approx(
        80e3, rel=0.01
    )


def test_the_sun_warms_the_gas_unless_the_scene_or_the_vehicle_says_otherwise():
    """Heat balance of an aluminised balloon: 0.017 K m2/W; a mission reports the same."""
    sunny = load_yaml(find_file('scenario', 'sunny_field'))
    prior = {'warming': 0.017, 'lag': 70.0, 'slack': 0.5}
    assert collect_scene_effects(GTMAB, load_scenario('sunny_field')) == {'superheat': prior}
    assert collect_scene_effects(GTMAB, load_scenario('hall_door'))['superheat'] == prior
    off = Scenario.model_validate(edited(sunny, {'daylight/slack': '0 %'}))
    assert collect_scene_effects(GTMAB, off) == {}
    assert collect_scene_effects(GTMAB, load_scenario('lamp_room')) == {}
    # A frame without a hull has no gas
    assert collect_scene_effects(load_vehicle('multirotor'), load_scenario('sunny_field')) == {}
    content = load_yaml(find_file('vehicle', 'gtmab'))
    own = {'slack': {'value': 0.2, 'unit': '1', 'source': 'test'}}
    content['effects']['superheat'] = own
    vehicle = Vehicle(VehicleFile.model_validate(content))
    assert collect_scene_effects(vehicle, load_scenario('sunny_field')) == {}


def test_who_leaves_by_the_door_is_in_bounds():
    def flown(*way):
        end = FlightTermination(load_scenario('hall_door'))
        return [end.evaluate_outcome(x, y, z, 0.0) is not FlightOutcome.ESCAPED for x, y, z in way]

    assert flown((0, 0, 1), (4.9, 0, 1), (5.1, 0, 1), (24, -19, 5)) == [True] * 4
    assert flown((4.9, 0, 1), (5.1, 0, 1), (4.9, 0, 1)) == [True] * 3
    assert flown((4.9, 2.1, 1), (5.1, 2.1, 1)) == [True, False]
    assert flown((4.9, 0, 3.6), (5.1, 0, 3.6)) == [True, False]
    assert flown((-4.9, 0, 1), (-5.1, 0, 1)) == [True, False]
    assert flown((5.1, 0, 1), (25.1, 0, 1)) == [True, False]


def test_the_wind_steps_at_the_door_over_the_width_of_the_hull():
    scenario = load_scenario('hall_door')
    world = World(GTMAB, scenario, load_topic_table(), 1)
    told = []
    for x in (0.0, 4.5, 5.0, 5.25, 5.5, 9.0):
        world._around.refresh((x, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), 3.7, 0.0)
        told.append(world._around.numbers[WIND + 1])
    assert told == pytest.approx([0.0, 0.0, -0.1, -0.15, -0.2, -0.2])
