# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The vehicle file: it says where every number is from, and diodes look anywhere."""

from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest
import yaml


def numbers(content, place=''):
    """Walk over everything that is or holds a number: (place, what stands there)."""
    if isinstance(content, dict) and 'value' in content:
        yield place, content
    elif isinstance(content, dict):
        for key, value in content.items():
            yield from numbers(value, f'{place}.{key}'.lstrip('.'))
    elif isinstance(content, list):
        for index, value in enumerate(content):
            yield from numbers(value, f'{place}.{index}')
    elif not isinstance(content, str | bool):
        yield place, content


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_every_number_of_a_platform_has_unit_and_source(name):
    content = load_yaml(find_file('vehicle', name))
    assert content['name'] == name
    found = dict(numbers(content))
    assert len(found) > 40
    # A count and the version of the format are no measurements.
    bare = {place for place, given in found.items() if not isinstance(given, dict)}
    counts = {'schema', 'sensors.diodes.count', 'energy.array.series', 'energy.array.parallel'}
    assert bare == counts & found.keys()
    for place, number in found.items():
        if isinstance(number, dict):
            assert number['unit'], place
            assert len(number['source'].strip()) >= 4, place


def test_sources_are_kept():
    file = load_vehicle_file('gtmab')
    assert file.parts['battery'].mass.source == 'seed paper, 1S 250 mAh'
    assert file.parts['battery'].mass.si == pytest.approx(0.007)


def test_diodes_may_look_anywhere(tmp_path):
    square = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    content = load_yaml(find_file('vehicle', 'gtmab'))
    content['sensors']['diodes'] |= {
        'count': 4, 'axes': {'value': square, 'source': 'test'}, 'dead': [2]
    }  # fmt: skip
    path = tmp_path / 'vehicle.yaml'
    path.write_text(yaml.safe_dump(content))
    diodes = load_vehicle_file(str(path)).sensors.diodes
    assert (diodes.axes.value, diodes.dead) == (square, [2])
    assert (diodes.response.si, diodes.gain_spread.si) == (1.2, pytest.approx(0.02))
    assert diodes.bandwidth.si == 14e3
