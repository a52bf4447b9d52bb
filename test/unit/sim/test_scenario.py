# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The scenario file: the shipped scene by hand, each mistake in one sentence, a moved start."""

import copy
import math

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.topics import load_topic_table
from lta_model.scenario import load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
import pytest
import yaml

ROOM = load_yaml(find_file('scenario', 'lamp_room'))


def written(tmp_path, place, value, scene='lamp_room'):
    """Return the path of a shipped scene with one place otherwise; None leaves it out."""
    content = copy.deepcopy(load_yaml(find_file('scenario', scene)))
    *way, last = place.split('.')
    part = content
    for key in way:
        part = part[key]
    if value is None:
        del part[last]
    else:
        part[last] = value
    path = tmp_path / 'scene.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


def metres(*numbers):
    return {'value': list(numbers), 'unit': 'm'}


def test_the_shipped_scene():
    scene = load_scenario('lamp_room')
    field = scene.light_field
    assert field.first_lamp.position == (3.5, 0.0, 1.0)
    assert tuple(field.first_lamp.axis) == (-1.0, 0.0, 0.0)
    assert field.first_lamp.flux == 10000.0
    assert field.first_lamp.wave.frequency == 150.0
    assert field.first_lamp.wave.duty == 0.5
    # One number a spectrum: 326 lm/W of the white LED, whatever names it
    assert field.first_lamp.efficacy == field.ambient.efficacy == luminous_efficacy('white_led')
    assert tuple(field.room.size) == (10.0, 8.0, 3.0)
    assert tuple(field.room.albedo) == (0.5, 0.5, 0.5)
    assert field.ambient.steady == 100.0
    assert field.ambient.mains == 20.0
    assert field.ambient.mains_frequency == 100.0
    x, y = scene.start.position.vector
    assert math.hypot(3.5 - x, y) == 7.0
    assert scene.start.heading_spread.si == pytest.approx(math.pi)
    assert scene.start.charge.si == pytest.approx(0.95)
    assert (scene.goal.radius.si, scene.goal.time_limit.si) == (1.0, 60.0)
    assert scene.goal.vertical_tolerance.si == 1.0


def test_density_by_hand(tmp_path):
    # 101325 / (287.05 * 293.15) = 1.20412; the tables' 1.2041 at 20 C and 1 atm.
    assert load_scenario('lamp_room').air.density == pytest.approx(1.20412, abs=5e-6)
    cold = load_scenario(str(written(tmp_path, 'air.temperature', '0 degC')))
    assert cold.air.density == pytest.approx(1.2923, abs=1e-4)
    thin = load_scenario(str(written(tmp_path, 'air.pressure', '900 hPa')))
    assert thin.air.density == pytest.approx(90000 / (287.05 * 293.15), rel=1e-12)


def test_a_lamp_in_the_corner_is_inside(tmp_path):
    assert load_scenario(str(written(tmp_path, 'lamp.position', metres(5, -4, 3))))


def lamps(tmp_path, change):
    """Return the path of the shipped scene with several lamps."""
    content = copy.deepcopy(ROOM)
    first = content.pop('lamp')
    second = {**first, 'frequency': '210 Hz', 'position': metres(0, 3, 2)}
    content['lamps'] = {'gate': first, 'shelf': second}
    change(content)
    path = tmp_path / 'scene.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return str(path)


def test_several_lamps_have_names_and_the_first_is_the_goal(tmp_path):
    scene = load_scenario(lamps(tmp_path, lambda content: None))
    assert scene.beacons == (('gate', 150.0), ('shelf', 210.0))
    assert scene.goal_lamp.position.vector == (3.5, 0.0, 1.0)
    assert [lamp.wave.frequency for lamp in scene.light_field.lamps] == [150.0, 210.0]


def test_each_kind_of_surface_may_have_its_albedo(tmp_path):
    given = {'floor': 0.2, 'walls': 0.5, 'ceiling': 0.8}
    room = load_scenario(str(written(tmp_path, 'room.albedo', given))).light_field.room
    assert room.albedo._asdict() == given
    # 80 m2 of floor and of ceiling, 108 m2 of walls.
    assert room.mean_albedo == pytest.approx((80 * 1.0 + 108 * 0.5) / 268)


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
