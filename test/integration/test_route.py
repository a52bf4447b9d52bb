"""A route over DDS: two lamps told apart by frequency, and one process flies the same."""

import json
from pathlib import Path

from lta_config.files import find_file, load_yaml
from lta_data.bag.recorded_flight import open_flight
import pytest
import yaml

pytestmark = pytest.mark.long


@pytest.fixture
def short(tmp_path):
    """Return the path of a hall with two lamps near each other, the drone looking at the first."""
    scene = load_yaml(find_file('scenario', 'warehouse'))
    scene['route'] = ['gate', 'aisle']
    scene['lamps']['gate']['position'] = {'value': [-6.6, -2, 0.5], 'unit': 'm'}
    scene['lamps']['aisle']['position'] = {'value': [-4.2, -2, 0.5], 'unit': 'm'}
    scene['lamps']['aisle']['facing'] = {'value': [-1, 0, 0], 'unit': '1'}
    del scene['lamps']['dock']
    scene['start']['heading_spread'] = '0 deg'
    path = tmp_path / 'short.yaml'
    path.write_text(yaml.safe_dump(scene))
    return path


def test_it_hands_over_from_lamp_to_lamp(lta, short, tmp_path):
    options = ('--strategy', 'homing', '--scenario', short, '--seed', '3', '--json')
    done = lta.run('fly', '--no-page', *options, '--out', tmp_path / 'graph')
    told = json.loads(done.stdout)
    assert (told['outcome'], done.returncode) == ('reached', 0), done.stderr
    beacons = wishes(told['bag'])
    assert beacons[0] == 150.0
    assert beacons[-1] == 230.0
    assert beacons == sorted(beacons)  # the first lamp is not asked for again
    alone = lta.run('simulate', *options, '--out', tmp_path / 'loop')
    assert alone.returncode == 0, alone.stderr
    assert wishes(json.loads(alone.stdout)['bag']) == beacons


def wishes(bag):
    """Return the frequencies that were asked for, in order. [Hz]"""
    return open_flight(Path(bag)).read_series('light/beacon')['data'].tolist()
