# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A recording sets numbers and chooses names that LTA ships; never a path, a module or a word."""

from contextlib import suppress
import sys

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_data.scene import read_recorded_file, read_scene
from lta_flight.recorded_choices import find_recorded_name, read_recorded_settings, SETTABLE
from pydantic import BaseModel
import pytest
import yaml

NODES = {block.node for block in SETTABLE.values()}
FILES = {'vehicle_file': 'gtmab', 'scenario_file': 'lamp_room', 'gains_file': 'gtmab'}
KINDS = {'vehicle_file': 'vehicle', 'scenario_file': 'scenario', 'gains_file': 'gains'}


def list_settings(model, prefix=''):
    """Yield the path of each setting of a model."""
    for name, field in model.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from list_settings(kind, f'{prefix}{name}.')
        else:
            yield f'{prefix}{name}'


# Also the parameters of the nodes that name files, which no flight in one process sets
SETTINGS = [
    *(f'{root}.{path}' for root, block in SETTABLE.items() for path in list_settings(block.model)),
    *(
        f'{root}.{name}'
        for root in SETTABLE
        for name in ('strategy', 'vehicle', 'scenario', 'law')
    ),
]


@pytest.fixture
def hostile(tmp_path):
    """Return what names a file that exists, a module, and a word of a shell."""
    for name in ('nav.py', 'nav.yaml', 'nav.csv'):
        (tmp_path / name).write_text('raise SystemExit')
    return [*map(str, sorted(tmp_path.iterdir())), 'nav:steer', 'os.system', '$(touch ran)', ';ls']


@pytest.fixture
def opened(tmp_path):
    """Return the files of this test's folder that were opened."""
    found = []
    watching = [True]

    def watch(event, arguments):
        if watching[0] and event == 'open' and str(arguments[0]).startswith(f'{tmp_path}'):
            found.append(arguments[0])

    sys.addaudithook(watch)  # stays for good, so it is switched off
    yield found
    watching[0] = False


@pytest.mark.parametrize('path', SETTINGS)
def test_no_setting_of_a_recording_is_a_text(path, hostile):
    for text in hostile:
        with pytest.raises(BadInput, match=r'refuses \(.*\); leave .* out of --nodes'):
            read_recorded_settings({'set': f'{path}={text}'}, NODES)


def test_a_whole_number_of_a_recording_is_set_as_the_float_that_a_node_declares():
    setting = read_recorded_settings({'set': 'mission.patience=5'}, NODES)['navigator']['patience']
    assert (setting, type(setting)) == (5.0, float)


def test_the_numbers_and_choices_of_a_recording_are_set_again():
    told = {
        'set': 'scenario.goal.time_limit=4 s; mission.altitude=0.6; prior.distance=2; '
        'reserve.action=perch; strategy=./nav.py; vehicle.trim.heaviness=2 g'
    }
    assert read_recorded_settings(told, NODES) == {
        'navigator': {'altitude': 0.6, 'reserve.action': 'perch'},
        'demodulator': {'prior.distance': 2},
    }
    assert read_recorded_settings({}, NODES) == {}
    assert read_recorded_settings({'set': 'mission.strategy=./nav.py'}, ['demodulator']) == {}


@pytest.mark.parametrize('kind', ['strategy', 'vehicle', 'scenario', 'gains'])
def test_a_name_of_a_recording_is_one_of_ltas_own(kind, hostile):
    for text in hostile:
        with pytest.raises(BadInput, match=f'because a recording names it; give it with --{kind}'):
            find_recorded_name({kind: text}, kind)
    own = 'lamp_room' if kind == 'scenario' else 'bag' if kind == 'strategy' else 'gtmab'
    assert find_recorded_name({kind: own}, kind) == own
    assert find_recorded_name({}, kind) is None


def list_texts(content, path=()):
    """Yield the path of each text in a file."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield from list_texts(value, (*path, key))
    elif isinstance(content, list):
        for k, value in enumerate(content):
            yield from list_texts(value, (*path, k))
    elif isinstance(content, str):
        yield path


def replace_at(content, path, value):
    """Replace a value of a file."""
    for key in path[:-1]:
        content = content.setdefault(key, {}) if isinstance(content, dict) else content[key]
    content[path[-1]] = value


@pytest.mark.parametrize('key', FILES)
def test_a_file_in_a_recording_opens_no_other(key, hostile, opened):
    """Whatever text it has is replaced by each path, and by what else may name something."""
    text = find_file(KINDS[key], FILES[key]).read_text(encoding='utf-8')
    places = [('aero',), ('air', 'recorded'), ('control', 'gains'), ('schema',)]
    places += [('/**/controller', 'ros__parameters', 'vehicle'), ('/**', 'ros__parameters', 'law')]
    # One of each name: the sources of numbers are many
    places += {place[-1]: place for place in list_texts(yaml.safe_load(text))}.values()
    read_scene({key: text})
    for k, place in enumerate(dict.fromkeys(places)):
        value = hostile[k % 3]
        content = yaml.safe_load(text)
        replace_at(content, place, value)
        told = {key: yaml.safe_dump(content)}
        with suppress(BadInput):
            read_scene(told)
    assert opened == []


def test_gains_in_a_recording_are_all_that_a_parameter_file_may_set():
    gains = {'/**/controller': {'ros__parameters': {'gains': {'heading_kp': 1.0}}}}
    more = {**gains, '/**': {'ros__parameters': {'strategy': './nav.py'}}}
    more['/**/controller']['ros__parameters']['vehicle'] = './nav.yaml'
    assert read_recorded_file({'gains_file': yaml.safe_dump(more)}, 'gains_file') == {
        '/**/controller': {'ros__parameters': {'gains': {'heading_kp': 1.0}}}
    }


def test_a_vehicle_that_was_flown_is_read_without_the_files_that_it_named():
    content = yaml.safe_load(find_file('vehicle', 'gtmab').read_text(encoding='utf-8'))
    content['control'] = {'law': 'cascade', 'gains': './mine.yaml', 'source': 'mine'}
    vehicle = read_scene({'vehicle_file': yaml.safe_dump(content)}).vehicle
    assert vehicle.control.gains is None
    content['control']['gains'] = 'gtmab'
    assert read_scene({'vehicle_file': yaml.safe_dump(content)}).vehicle.control.gains == 'gtmab'
