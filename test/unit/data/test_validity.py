# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight outside the region that the numbers of its vehicle file were fitted to is reported."""

from lta_config.files import find_file, parse_yaml
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.vehicle_edit import set_yaml_values
from lta_data.scene import describe_exceeded_region, list_motion
import numpy as np
import pytest

LIMITS = {
    'speed': (0.4, 0.8),
    'roll': (-0.2, 0.2),
    'pitch': (-0.2, 0.2),
    'roll_rate': (-0.5, 0.5),
    'pitch_rate': (-0.5, 0.5),
    'yaw_rate': (-1.0, -0.4),
}
UNITS = {'speed': 'm/s', 'roll': 'rad', 'pitch': 'rad'}
COUNT = 100


@pytest.fixture(scope='module')
def vehicle() -> VehicleFile:
    """The RGBlimp, with a region of validity."""
    text = find_file('vehicle', 'rgblimp').read_text(encoding='utf-8')
    for name, ends in LIMITS.items():
        node = {'value': list(ends), 'unit': UNITS.get(name, 'rad/s'), 'source': 'a test'}
        text = set_yaml_values(text, {f'validity.{name}': node})
    node = {'value': [0.2, 0.9], 'unit': '1', 'source': 'a test'}
    text = set_yaml_values(text, {'validity.commands.left': node})
    return VehicleFile.model_validate(parse_yaml(text, 'a test'))


def motion(speed: float, yaw_rate: float) -> dict[str, np.ndarray]:
    """Return a level flight at a speed and a rate of turn."""
    velocity, rates = np.zeros((COUNT, 3)), np.zeros((COUNT, 3))
    velocity[:, 0], rates[:, 2] = speed, yaw_rate
    return list_motion(np.tile([0.0, 0.0, 0.0, 1.0], (COUNT, 1)), velocity, rates)


def test_a_flight_inside_gives_no_warning(vehicle: VehicleFile) -> None:
    assert describe_exceeded_region(vehicle, motion(0.6, -0.7)) == ''


def test_a_straight_fast_flight_is_outside_in_one_sentence(vehicle: VehicleFile) -> None:
    told = describe_exceeded_region(vehicle, motion(1.2, 0.0))
    assert 'speed 1.2 to 1.2 (fitted: 0.4 to 0.8) m/s' in told
    assert 'yaw rate 0 to 0 (fitted: -1 to -0.4) rad/s' in told
    assert 'roll' not in told
    assert told.count('. ') == 0


def test_commands_are_limited_by_the_name_of_their_rotor(vehicle: VehicleFile) -> None:
    flown = motion(0.6, -0.7)
    assert describe_exceeded_region(vehicle, {**flown, 'left': np.full(COUNT, 0.5)}) == ''
    told = describe_exceeded_region(vehicle, {**flown, 'left': np.full(COUNT, 1.0)})
    assert 'left 1 to 1 (fitted: 0.2 to 0.9)' in told


def test_a_moment_outside_and_unknown_values_are_ignored(vehicle: VehicleFile) -> None:
    flown = motion(0.6, -0.7)
    flown['speed'][:4] = 2.0
    flown['yaw_rate'][:] = np.nan
    assert describe_exceeded_region(vehicle, flown) == ''
    flown['speed'][:8] = 2.0
    assert 'speed' in describe_exceeded_region(vehicle, flown)
