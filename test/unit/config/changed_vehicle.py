"""GT-MAB's file with changes, and what it is refused with."""

import copy

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest
import yaml

GTMAB = load_yaml(find_file('vehicle', 'gtmab'))


def put(content, place, value):
    """Set, or with None remove, the entry at a dotted place."""
    *way, last = place.split('.')
    for key in way:
        content = content[key]
    if value is None:
        del content[last]
    else:
        content[last] = value


def refused(tmp_path, *changes):
    content = copy.deepcopy(GTMAB)
    for place, value in changes:
        put(content, place, value)
    path = tmp_path / 'vehicle.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    with pytest.raises(BadInput) as caught:
        load_vehicle_file(str(path))
    text = str(caught.value)
    assert text.startswith(f'{path}: ')
    return text.removeprefix(f'{path}: ')


def given(value, unit):
    return {'value': value, 'unit': unit, 'source': 'test'}


def without(content, *keys):
    return {key: value for key, value in content.items() if key not in keys}
