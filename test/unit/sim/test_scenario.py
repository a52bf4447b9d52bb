"""The scenario file: the shipped scene by hand, and each mistake in one sentence."""

import copy
import math

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_model.scenario import load_scenario
import pytest
import yaml

ROOM = load_yaml(find_file('scenario', 'lamp_room'))


def written(tmp_path, place, value):
    content = copy.deepcopy(ROOM)
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


@pytest.mark.parametrize(
    ('place', 'value', 'sentence'),
    [
        ('lights', [], "the key 'lights' is not known; remove it or correct its spelling."),
        ('lamp.power', '1 W', "the key 'lamp.power' is not known; remove it or correct its"),
        ('goal.radius', None, "the key 'goal.radius' is missing; add it."),
        ('schema', 7, 'schema is 7, but must be 1.'),
        ('lamp.flux', 10000, 'lamp.flux is 10000 and has no unit; write for example "10000 lm".'),
        ('lamp.flux', '10000 lx', 'lamp.flux is in lx, but must be in lm or a compatible unit.'),
        ('lamp.flux', '-1 lm', 'lamp.flux is -1 lm, but must be from 0 to 1e+07 lm.'),
        ('lamp.frequency', '0 Hz', 'lamp.frequency is 0 Hz, but must be above 0'),
        ('lamp.duty', '100 %', 'lamp.duty is 100 %, but must be above 0 and at most 99.9 %.'),
        ('lamp.position', metres(1, 2), 'lamp.position has 2 numbers, but needs 3.'),
        ('room.size', metres(10, 0, 3), 'room.size is [10, 0, 3] m, but must be above 0'),
        ('lamp.efficacy', None, "the key 'lamp.efficacy' is missing; add it."),
        (
            'lamp.efficacy',
            '684 lm/W',
            'lamp.efficacy is 684 lm/W, but must be above 0 and at most 683 lm/W.',
        ),
        ('ambient.efficacy', '0 lm/W', 'ambient.efficacy is 0 lm/W, but must be above 0'),
        ('room.albedo', 1.0, 'room.albedo is 1.0, but must be below 1.'),
        ('room.albedo', math.nan, 'room.albedo is nan, but must be'),
        ('air.temperature', '20 F', 'air.temperature has the unknown unit "F"; known: 1, %,'),
        ('air.pressure', '1 hPa', 'air.pressure is 1 hPa, but must be from 500 to 1200 hPa.'),
        ('start.charge', '101 %', 'start.charge is 101 %, but must be from 0 to 100 %.'),
        ('start.heading', '90 degree', 'start.heading has the unknown unit "degree"; known:'),
        ('goal.time_limit', '0 s', 'goal.time_limit is 0 s, but must be above 0'),
        (
            'lamp.position',
            metres(5.1, 0, 1),
            'the file has its lamp at (5.1, 0.0, 1.0) m, outside',
        ),
        ('lamp.position', metres(0, -4.1, 1), 'the file has its lamp at (0.0, -4.1, 1.0) m, out'),
        (
            'lamp.position',
            metres(0, 0, 3.1),
            'the file has its lamp at (0.0, 0.0, 3.1) m, outside',
        ),
        ('lamp.position', metres(0, 0, -0.1), 'the file has its lamp at (0.0, 0.0, -0.1) m, outs'),
        (
            'start.position',
            metres(-5.1, 0),
            'the file has its start at (-5.1, 0.0) m, outside the',
        ),
        ('start.position', metres(0, 4.1), 'the file has its start at (0.0, 4.1) m, out'),
    ],
)
def test_a_mistake_is_one_sentence(tmp_path, place, value, sentence):
    path = written(tmp_path, place, value)
    with pytest.raises(BadInput) as caught:
        load_scenario(str(path))
    text = str(caught.value)
    assert text.startswith(f'{path}: {sentence}')
    assert text.endswith('.')
    assert '\n' not in text


def test_a_lamp_in_the_corner_is_inside(tmp_path):
    assert load_scenario(str(written(tmp_path, 'lamp.position', metres(5, -4, 3))))


def test_a_lamp_that_faces_nowhere_is_refused(tmp_path):
    nowhere = {'value': [0, 0, 0], 'unit': '1'}
    scene = load_scenario(str(written(tmp_path, 'lamp.facing', nowhere)))
    with pytest.raises(BadInput) as caught:
        _ = scene.light_field
    assert str(caught.value).endswith('.')


def test_a_start_within_the_goal_is_refused(tmp_path):
    path = written(tmp_path, 'start.position', {'value': [2.6, 0.0], 'unit': 'm'})
    with pytest.raises(BadInput, match='starts within its goal; move the start'):
        load_scenario(str(path))


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


@pytest.mark.parametrize(
    ('change', 'sentence'),
    [
        (
            lambda c: c.update(lamp=c['lamps']['gate']),
            'either one lamp under "lamp", or several named lamps',
        ),
        (lambda c: c.pop('lamps'), 'either one lamp under "lamp", or several named lamps'),
        (lambda c: c.update(lamps={}), 'either one lamp under "lamp", or several named lamps'),
        (
            lambda c: c['lamps']['shelf'].update(position=metres(0, 0, 9)),
            'has its shelf at (0.0, 0.0, 9.0) m, outside the room',
        ),
        (
            lambda c: c['lamps']['shelf'].update(half_power='90 deg'),
            'lamps.shelf.half_power is 90 deg, but must be from 2.86479 to 88.8085 deg.',
        ),
        (
            lambda c: c['lamps']['shelf'].update(clock_error='2 %'),
            'lamps.shelf.clock_error is 2 %, but must be from -1 to 1 %.',
        ),
        (lambda c: c['room'].update(albedo={'floor': 0.5}), "'room.albedo.walls' is missing"),
        (
            lambda c: c['room'].update(albedo={'floor': 1.5, 'walls': 0.5, 'ceiling': 0.5}),
            'room.albedo.floor is 1.5, but must be below 1.',
        ),
        (
            lambda c: c['ambient'].update(mains_harmonics={'value': [20, 300], 'unit': '%'}),
            'ambient.mains_harmonics is [20, 300] %, but must be from 0 to 100 %.',
        ),
    ],
)
def test_a_mistake_in_several_lamps_is_one_sentence(tmp_path, change, sentence):
    with pytest.raises(BadInput) as caught:
        load_scenario(lamps(tmp_path, change))
    assert sentence in str(caught.value)


def test_each_kind_of_surface_may_have_its_albedo(tmp_path):
    given = {'floor': 0.2, 'walls': 0.5, 'ceiling': 0.8}
    room = load_scenario(str(written(tmp_path, 'room.albedo', given))).light_field.room
    assert room.albedo._asdict() == given
    # 80 m2 of floor and of ceiling, 108 m2 of walls.
    assert room.mean_albedo == pytest.approx((80 * 1.0 + 108 * 0.5) / 268)
