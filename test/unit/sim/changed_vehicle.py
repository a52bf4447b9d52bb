# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""GT-MAB's file with something changed, for tests of what follows from a vehicle file."""

import copy

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import Vehicle
import pytest

G = 9.80665
RHO = 1.2041
GTMAB = load_yaml(find_file('vehicle', 'gtmab'))
PARTS = {name: part for layer in GTMAB['layers'].values() for name, part in layer.items()}
VOLUME = 2.7458 * 0.5**3  # 0.3432 m3


def changed(*changes):
    """Return GT-MAB's file with dotted places set, or removed with None."""
    content = copy.deepcopy(GTMAB)
    for place, value in changes:
        *way, last = place.split('.')
        part = content
        for key in way:
            part = part[key]
        if value is None:
            del part[last]
        else:
            part[last] = value
    return content


def build(*changes, density=RHO):
    return Vehicle(VehicleFile.model_validate(changed(*changes)), density)


def refused(*changes):
    with pytest.raises(BadInput) as caught:
        build(*changes)
    text = str(caught.value)
    assert '\n' not in text
    return text


def given(value, unit):
    return {'value': value, 'unit': unit, 'source': 'test'}
