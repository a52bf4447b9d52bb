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


SECOND_LAMP = {'lamps': {'gate': ROOM['lamp'], 'shelf': {**ROOM['lamp'], 'frequency': '210 Hz'}}}
FIELD = {'wind': '8 m/s', 'towards': '180 deg', 'roughness': '0.3 m'}
ROUGH = {'intensity': '0.3 m/s', 'length': '2 m'}
WRONG = [  # of which scene, the place, what stands there (None: nothing), and what is said
    (
        'lamp_room',
        'lights',
        [],
        "the key 'lights' is not known; remove it or correct its spelling",
    ),
    ('lamp_room', 'goal.radius', None, "the key 'goal.radius' is missing; add it."),
    ('lamp_room', 'lamp.flux', 10000, 'lamp.flux is 10000 and has no unit; write for example "1'),
    ('lamp_room', 'lamp.facing', {'value': [0, 0, 0], 'unit': '1'}, 'axis of the lamp is zero'),
    ('lamp_room', 'room.albedo', 1.0, 'room.albedo is 1.0, but must be below 1.'),
    ('lamp_room', 'room.albedo', {'floor': 0.5}, "'room.albedo.walls' is missing"),
    ('lamp_room', 'room.walls', 'brick', "room.walls is 'brick', but must be 'solid' or 'open'."),
    (
        'lamp_room',
        'lamp.position',
        metres(5.1, 0, 1),
        'has its lamp at (5.1, 0.0, 1.0) m, outside',
    ),
    (
        'lamp_room',
        'lamp.position',
        metres(0, 0, 3.1),
        'has its lamp at (0.0, 0.0, 3.1) m, outside',
    ),
    ('lamp_room', 'lamp.position', metres(0, 0, -0.1), 'its lamp at (0.0, 0.0, -0.1) m, outside'),
    ('lamp_room', 'start.position', metres(-5.1, 0), 'has its start at (-5.1, 0.0) m, outside'),
    ('lamp_room', 'start.position', metres(2.6, 0), 'starts within its goal; move the start'),
    ('lamp_room', 'lamp', None, 'either one lamp under "lamp", or several named lamps'),
    ('lamp_room', 'lamps', SECOND_LAMP['lamps'], 'either one lamp under "lamp", or several named'),
    (
        'lamp_room',
        'air.profile',
        {**FIELD, 'height': '0.2 m'},
        'a height of 0.2 m, which is not above the roughness length of 0.3 m;',
    ),
    (
        'lamp_room',
        'air.turbulence',
        {'intensity': '0.3 m/s'},
        'needs either intensity and length,',
    ),
    (
        'lamp_room',
        'air.turbulence',
        {'by': 'MIL-F-8785C', 'wind': '8 m/s', 'height': '0.5 m'},
        'MIL-F-8785C defines no low-altitude turbulence at a height of 0.5 m, only from 3.05',
    ),
    (
        'lamp_room',
        'air.turbulence',
        {**ROUGH, 'sheared': True},
        'and the wind of the scene; add "by: MIL-F-8785C" and remove intensity, length',
    ),
    ('lamp_room', 'air.recorded', 'wind.txt', 'air.recorded'),
    ('hall_door', 'room.walls', 'solid', 'its walls are solid'),
    ('hall_door', 'lamp.position', metres(26, 0, 1), 'outside the room'),
    ('hall_door', 'outside.door.middle', '3 m', 'does not fit into a wall of 8 by 4 m'),
]


@pytest.mark.parametrize(('scene', 'place', 'value', 'sentence'), WRONG)
def test_a_mistake_is_one_sentence(tmp_path, scene, place, value, sentence):
    path = written(tmp_path, place, value, scene)
    with pytest.raises(BadInput) as caught:
        _ = load_scenario(str(path)).light_field
    text = str(caught.value)
    assert sentence in text
    assert text.endswith('.')
    assert '\n' not in text


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
