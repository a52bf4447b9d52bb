"""A moved start is the start moved, and nothing else; where a drone cannot stand is refused."""

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_model.scenario import load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
import pytest

SCENE = load_scenario('lamp_room')


def test_no_offset_is_the_scenario_itself():
    assert offset_start(SCENE, 0.0, 0.0) is SCENE
    assert offset_start(SCENE, -0.0, 0.0) is SCENE


def test_the_drone_stands_there_with_the_same_heading_and_chance():
    vehicle = load_vehicle('gtmab', SCENE.air.density)
    here = World(vehicle, SCENE, load_topic_table(), 3)
    there = World(vehicle, offset_start(SCENE, 0.5, -2.0), load_topic_table(), 3)
    moved = there.state - here.state
    assert moved[:2].tolist() == [0.5, -2.0]
    assert not moved[2:].any()
    assert there.sense_motion().rates == here.sense_motion().rates


@pytest.mark.parametrize(
    ('x', 'y', 'why'),
    [
        (0.0, 4.5, 'has its start at (-3.5, 4.5) m, outside the room'),
        (6.5, 0.0, 'within its goal'),
    ],
)
def test_an_offset_out_of_the_room_or_into_the_goal_is_one_sentence(x, y, why):
    with pytest.raises(BadInput) as caught:
        offset_start(SCENE, x, y)
    sentence = str(caught.value)
    assert f"With a start offset of {x:g}, {y:g} m the scenario 'lamp_room'" in sentence
    assert why in sentence
    assert sentence.endswith('give another offset_x or offset_y.')
