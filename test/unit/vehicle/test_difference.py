# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where two vehicles differ, and what follows from it."""

import re

from lta_config.files import find_file
from lta_model.vehicle import load_vehicle
from lta_vehicle.difference import compare_vehicles, find_changes, load_vehicle_variant
from lta_vehicle.views.sheet_summary import encode_difference
import pytest

BATTERY = 'layers.propulsion_and_control.battery.mass'


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab')


def shifts(found):
    return {item.figure.key: item.shift for item in found.consequences}


def test_a_heavier_battery_takes_its_weight_off_the_ballast(gtmab):
    """7 g move from 39.5 to 36.5 cm below the centre: the CG of 415.3 g rises by 0.0506 cm."""
    found = compare_vehicles(gtmab, load_vehicle_variant('gtmab', [f'{BATTERY}=14 g']))
    assert [change.place for change in found.changes] == [BATTERY]
    (change,) = found.changes
    assert (change.before.value, change.after.value) == ('7 g', '14 g')
    shift = shifts(found)
    assert shift['ballast'] == pytest.approx(-7.0)
    assert shift['cg_depth'] == pytest.approx(-7.0 * 3.0 / 415.28, rel=1e-3)
    assert 'heaviness' not in shift
    assert 'mass' not in shift
    assert 'hover_duty' not in shift


def test_a_heavier_vehicle_hovers_harder(gtmab):
    found = compare_vehicles(gtmab, load_vehicle_variant('gtmab', ['vehicle.trim.heaviness=4 g']))
    shift = shifts(found)
    assert shift['ballast'] == pytest.approx(2.0)
    assert shift['mass'] == pytest.approx(2.0)
    assert shift['hover_loss'] == pytest.approx(-2.0)
    assert shift['hover_duty'] > 0.0
    assert shift['level_speed'] > 0.0  # its nose rises later


def test_the_same_in_other_units_is_no_difference(tmp_path):
    text = find_file('vehicle', 'gtmab').read_text('utf-8')
    text = text.replace('value: 116.8, unit: g', 'value: 0.1168, unit: kg')
    (tmp_path / 'same.yaml').write_text(text)
    found = compare_vehicles(load_vehicle('gtmab'), load_vehicle(str(tmp_path / 'same.yaml')))
    assert found.changes == []
    assert found.consequences == []


def test_an_effect_that_is_switched_on_comes_with_its_source(gtmab, tmp_path):
    text = (
        find_file('vehicle', 'gtmab')
        .read_text('utf-8')
        .replace(
            '\neffects:\n',
            '\neffects:\n  thrust_scale:\n'
            '    factor: {value: 0.93, unit: "1", source: "discovery: 0.93, 95 % 0.91 to 0.95"}\n',
        )
    )
    (tmp_path / 'learned.yaml').write_text(text)
    other = load_vehicle(str(tmp_path / 'learned.yaml'))
    (change,) = find_changes(gtmab.file, other.file)
    assert change.place == 'effects.thrust_scale.factor'
    assert change.before is None
    assert change.after.source == 'discovery: 0.93, 95 % 0.91 to 0.95'


def test_a_part_that_only_one_has_is_one_change(gtmab):
    found = find_changes(gtmab.file, load_vehicle('sblimp').file)
    by_place = {change.place: change for change in found}
    motors = by_place['layers.quadrotor.motors']
    assert motors.before is None
    assert motors.after.value == '11.6 g'
    assert not any(place.startswith('layers.quadrotor.motors.') for place in by_place)
    assert by_place['rotors.up_left'].after is None
    assert 'hull.diameter' in by_place


def test_scripts_get_numbers_in_si(gtmab):
    found = encode_difference(
        compare_vehicles(gtmab, load_vehicle_variant('gtmab', [f'{BATTERY}=14 g']))
    )
    (change,) = found['changes']
    assert change['before']['value'] == pytest.approx(0.007)
    assert change['after']['unit'] == 'kg'
    ballast = found['consequences']['ballast']
    assert ballast['after'] - ballast['before'] == pytest.approx(-7.0)


def test_diff_warns_of_a_number_that_changed_while_its_source_did_not(tmp_path):
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    old = re.search(r'heaviness: \{value: 2, unit: g, source: "([^"]*)"[^}]*\}', text)
    known = old[0].replace(old[1], 'kitchen scale')
    paths = {}
    for name, line in (
        ('known', known),
        ('stale', known.replace('value: 2,', 'value: 2.4,')),
        ('new', known.replace('value: 2,', 'value: 2.4,').replace('kitchen', 'laboratory')),
        (
            'assumed',
            known.replace('value: 2,', 'value: 2.4,').replace('kitchen scale', 'assumed: as'),
        ),
        ('first', known.replace('kitchen scale', 'assumed: as')),
    ):
        paths[name] = tmp_path / f'{name}.yaml'
        paths[name].write_text(text.replace(old[0], line))
    vehicles = {name: load_vehicle(str(path)) for name, path in paths.items()}
    (told,) = compare_vehicles(vehicles['known'], vehicles['stale']).warnings
    assert told == (
        'Changed, but the source did not: trim.heaviness ("kitchen scale"); name the new source '
        'with lta vehicle set --source.'
    )
    assert compare_vehicles(vehicles['known'], vehicles['new']).warnings == []
    assert compare_vehicles(vehicles['first'], vehicles['assumed']).warnings == []
