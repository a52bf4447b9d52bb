"""Mission files and lights of the day: what is shipped is whole, what is wrong is one sentence."""

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.mission_file import load_light_day, load_mission
import pytest
import yaml

MISSIONS, DAYS = list_shipped_names('missions'), list_shipped_names('light_days')


@pytest.mark.parametrize('name', MISSIONS)
def test_shipped_missions_are_what_their_files_are_called(name):
    mission = load_mission(name)
    assert mission.name == name
    assert mission.light in DAYS
    assert mission.scene in list_shipped_names('scenarios')


@pytest.mark.parametrize('name', DAYS)
def test_shipped_lights_are_what_their_files_are_called(name):
    assert load_light_day(name).name == name


def changed(kind, name, tmp_path, change):
    """Return a shipped file with something changed."""
    content = load_yaml(find_file(kind, name))
    change(content)
    path = tmp_path / f'{name}.yaml'
    path.write_text(yaml.safe_dump(content), encoding='utf-8')
    return str(path)


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        (lambda c: c['round'].append('home'), 'has the perch home in its "round"'),
        (lambda c: c.update(round=[]), 'round'),
        (lambda c: c['work'].update(value=[7, 30]), 'work'),
        (lambda c: c['asleep'].pop('source'), 'source'),
        (lambda c: c['duty'].update(rest=0.0), 'duty.rest'),
        (lambda c: c.update(wings=2), 'wings'),
    ],
)
def test_a_mission_that_cannot_be_is_one_sentence(tmp_path, change, words):
    path = changed('mission', 'greenhouse', tmp_path, change)
    with pytest.raises(BadInput) as caught:
        load_mission(path)
    told = str(caught.value)
    assert words in told
    assert path in told
    assert told.count('. ') == 0


@pytest.mark.parametrize(
    ('name', 'change', 'words'),
    [
        ('warehouse_dock', lambda c: c.pop('lamps'), 'neither "sun" nor "lamps"'),
        (
            'warehouse_dock',
            lambda c: c['lamps']['hall'].update(duty=c['lamps']['beacon']['duty']),
            'several flickering lamps',
        ),
        (
            'greenhouse_spring',
            lambda c: c['sun']['clouds']['cover'].update(value=[90, 10]),
            'has a lower bound of "cover" that is above its upper bound',
        ),
    ],
)
def test_a_light_that_cannot_be_is_one_sentence(tmp_path, name, change, words):
    path = changed('light of the day', name, tmp_path, change)
    with pytest.raises(BadInput, match=r'.*') as caught:
        load_light_day(path)
    assert words in str(caught.value)
