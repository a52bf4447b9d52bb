# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Vehicle files and mounts: sources of every number, diodes, and what their hash is of."""

from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.crazyflie_file import hash_airframe, hash_diodes, load_crazyflie
from lta_config.schema.mount_file import load_mount, mount_panels
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


GTMAB, WIRING = load_vehicle_file('gtmab'), load_crazyflie('gtmab')
ROTORS = GTMAB.rotors


def changed_rotor(**change):
    rotor = ROTORS['up_left'].model_copy(update=change)
    return GTMAB.model_copy(update={'rotors': {**ROTORS, 'up_left': rotor}})


def swapped():
    motors = dict(WIRING.motors)
    motors['m1'], motors['m2'] = motors['m2'], motors['m1']
    return WIRING.model_copy(update={'motors': motors})


@pytest.mark.parametrize(
    ('vehicle', 'wiring'),
    [
        (GTMAB, swapped()),
        (GTMAB.model_copy(update={'name': 'other'}), WIRING),
        (changed_rotor(position=ROTORS['up_right'].position), WIRING),
        (changed_rotor(axis=ROTORS['forward_left'].axis), WIRING),
        (changed_rotor(reversible=True), WIRING),
    ],
)
def test_what_would_turn_a_wrong_motor_changes_the_hash(vehicle, wiring):
    assert hash_airframe(vehicle, wiring) != hash_airframe(GTMAB, WIRING)


def test_masses_and_limits_may_be_measured_anew():
    lighter = GTMAB.model_copy(update={'layers': {}, 'about': 'trimmed'})
    assert hash_airframe(lighter, WIRING) == hash_airframe(GTMAB, WIRING)
    assert hash_diodes(lighter) == hash_diodes(GTMAB)


def test_another_number_of_diodes_changes_the_hash():
    diodes = GTMAB.sensors.diodes.model_copy(update={'count': 16})
    sensors = GTMAB.sensors.model_copy(update={'diodes': diodes})
    assert hash_diodes(GTMAB.model_copy(update={'sensors': sensors})) != hash_diodes(GTMAB)


VEHICLE = load_yaml(find_file('vehicle', 'gtmab'))


@pytest.mark.parametrize('name', list_shipped_names('mounts'))
def test_every_mount_carries_the_papers_panels(name):
    mount = load_mount(name)
    panels = [mount.parts[panel] for panel in mount.panels]
    assert sum(part.mass.si for part in panels) == pytest.approx(48.8e-3, rel=1e-12)
    faces = [sorted(part.size.vector)[1:] for part in panels]
    assert sum(a * b for a, b in faces) == pytest.approx(138.84e-4, rel=1e-12)


def test_the_papers_frame_weighs_45_5_grams_and_reaches_40_cm():
    mount = load_mount('bottom')
    arms = [part for name, part in mount.parts.items() if name not in mount.panels]
    assert sum(part.mass.si for part in arms) == pytest.approx(45.5e-3, rel=1e-12)
    assert {part.size.vector[1] for part in arms} == {0.4}


def test_a_mount_takes_the_place_of_a_layer_and_of_nothing_else():
    made = mount_panels(VEHICLE, 'side')
    assert list(made['layers']) == list(VEHICLE['layers'])
    assert set(made['layers']['top']) == {'panel_left', 'panel_right'}
    changed = {key for key in made if made[key] != VEHICLE[key]}
    assert changed == {'name', 'layers', 'energy'}
    assert made['energy']['array']['part'] == 'panel_left'
    assert made['energy']['array']['normal']['value'] == [0.0, 1.0, 0.0]


def test_misplaced_panels_sit_ahead_and_their_frame_does_not():
    made = mount_panels(VEHICLE, 'bottom', ahead=0.03)['layers']['top']
    straight = mount_panels(VEHICLE, 'bottom')['layers']['top']
    assert made['panel_left']['position']['value'] == pytest.approx([0.03, 0.56, -0.36])
    assert made['arm_left'] == straight['arm_left']
