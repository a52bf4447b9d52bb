"""Scenes in the sun and with a door: the resistor for their light, wind and bounds at the door."""

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.topics import load_topic_table
from lta_model.light.gain_selection import compute_gain_scale, select_diode_gain
from lta_model.light.view import LightView
from lta_model.scenario import load_scenario, Scenario
from lta_model.state import WIND
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.termination import FlightTermination
from lta_sim.world import World
from lta_vlc.demodulation import demodulate_beacon, plan_bins
from lta_vlc.settings import DemodulationSettings
import numpy as np
from pydantic import ValidationError
import pytest

from .lamp_room import edited

GTMAB = load_vehicle('gtmab')
DOOR = load_yaml(find_file('scenario', 'hall_door'))


@pytest.mark.parametrize(
    ('scene', 'resistor'), [('lamp_room', 1e5), ('sunny_field', 1e4), ('hall_door', 1e4)]
)
def test_the_resistor_suits_the_light(scene, resistor):
    assert (
        select_diode_gain(load_scenario(scene).light_field, GTMAB).feedback_resistance == resistor
    )
    assert compute_gain_scale(scene, 'gtmab') == resistor / 1e5


def test_with_one_resistor_or_no_scene_there_is_nothing_to_tell():
    assert compute_gain_scale('sunny_field', 'skye') == 1.0
    assert compute_gain_scale('', 'gtmab') == 1.0


@pytest.mark.parametrize('scene', ['lamp_room', 'sunny_field'])
def test_the_lamp_is_heard_at_seven_metres(scene):
    """SNR above 10 in a room with mains, and at 80 klx."""
    field = load_scenario(scene).light_field
    view = LightView(field, GTMAB, select_diode_gain(field, GTMAB))
    view.record_pose((-3.5, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0))
    block = view.sample_light_block(10**9, 1e4, 1000, np.random.default_rng(1))
    snr = demodulate_beacon(block, plan_bins(DemodulationSettings(), 1e4, 1000)).snr
    assert snr.argmax() == 0
    assert snr.max() > 30.0
    assert block.max() < 4095


def test_the_sunny_field_has_80_klx():
    assert load_scenario('sunny_field').light_field.daylight.ground_illuminance == pytest.approx(
        80e3, rel=0.01
    )


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


def test_a_flight_over_the_lamp_has_not_reached_it():
    """The lamp of the sunny field is at 1 m, and its tolerance is 1 m."""
    end = FlightTermination(load_scenario('sunny_field'))
    outcomes = [end.evaluate_outcome(3.5, 0.9, z, 0.0) for z in (6.85, 2.01, 1.99, 0.0)]
    assert outcomes == [FlightOutcome.FLYING] * 2 + [FlightOutcome.REACHED] * 2
    assert end.evaluate_outcome(3.5, 1.1, 1.0, 0.0) is FlightOutcome.FLYING


def test_the_wind_steps_at_the_door_over_the_width_of_the_hull():
    scenario = load_scenario('hall_door')
    world = World(GTMAB, scenario, load_topic_table(), 1)
    told = []
    for x in (0.0, 4.5, 5.0, 5.25, 5.5, 9.0):
        world._around.refresh((x, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), 3.7, 0.0)
        told.append(world._around.numbers[WIND + 1])
    assert told == pytest.approx([0.0, 0.0, -0.1, -0.15, -0.2, -0.2])


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        ({'room/walls': 'solid'}, 'its walls are solid'),
        ({'lamp/position': {'value': [26, 0, 1], 'unit': 'm'}}, 'outside the room'),
        ({'outside/door/width': '0 m'}, 'must be above 0 and'),
    ],
)
def test_a_mistake_at_the_door_is_one_sentence(changes, sentence):
    with pytest.raises(ValidationError, match=sentence):
        Scenario.model_validate(edited(DOOR, changes))


def test_a_door_must_fit_its_wall():
    scene = Scenario.model_validate(edited(DOOR, {'outside/door/middle': '3 m'}))
    with pytest.raises(BadInput, match='does not fit into a wall of 8 by 4 m'):
        _ = scene.light_field
