# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Columns of another place, and drag of another hull, against levers by hand."""

from io import StringIO
import math

from lta_config.files import list_shipped_names
from lta_config.schema.vehicle_aero import load_aero_file
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.propulsion import geometric_column
from lta_model.vehicle import load_vehicle
from lta_vehicle.difference import compare_vehicles, find_stale_columns, load_vehicle_variant
from lta_vehicle.views.sheet_summary import encode_difference, show_difference
import pytest
from rich.console import Console

WIDE = [
    'rotors.forward_left.position=[0, 20, -40] cm',
    'rotors.forward_right.position=[0, -20, -40] cm',
]
# Vehicles, and vehicles as they fly with what is shipped beside them.
FLOWN = [
    *((name, None) for name in list_shipped_names('vehicles')),
    *((load_aero_file(name).vehicle, name) for name in list_shipped_names('aero', '.aero.yaml')),
]


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab')


def warned(*sets):
    return list(find_stale_columns(load_vehicle_variant('gtmab', sets).file))


def file_of(vehicle, aero):
    file = load_vehicle_file(vehicle)
    return file.model_copy(update={'aero': load_aero_file(aero).aero}) if aero else file


@pytest.mark.parametrize(('vehicle', 'aero'), FLOWN)
def test_no_shipped_column_is_called_outdated(vehicle, aero):
    assert list(find_stale_columns(file_of(vehicle, aero))) == []


def test_the_thresholds_have_room_above_all_that_is_shipped():
    """What the module says of the farthest shipped column: 3.8 degrees, 1.1 % of the distance."""
    angles, shares = [], []
    for file in (file_of(*each) for each in FLOWN):
        for name, column in file.aero.thrust_allocation.items():
            rotor, force = file.rotors[name], column.force.vector
            plain = geometric_column(rotor)
            along = sum(a * b for a, b in zip(force, plain[:3], strict=True))
            angles.append(math.degrees(math.acos(along / math.hypot(*force))))
            off = math.dist(column.moment.vector, plain[3:])
            shares.append(off / math.hypot(*rotor.position.vector))
    assert max(angles) == pytest.approx(3.8, abs=0.05)
    assert max(shares) == pytest.approx(0.011, abs=0.0005)


def test_place_and_axis_make_a_column_by_hand(gtmab):
    """A push of 1 N forward, 10 cm to the left and 40 cm below: -0.4 N m nose up, -0.1 left."""
    assert geometric_column(gtmab.file.rotors['forward_left']) == pytest.approx(
        (1.0, 0.0, 0.0, 0.0, -0.4, -0.1)
    )


def test_rotors_twice_as_far_out_should_turn_it_twice_as_much():
    left, right = warned(*WIDE)
    assert left == (
        'From its position and axis, the rotor forward_left has a moment of (0.0, -40.0, -20.0) N '
        'cm per newton of thrust, but its column of aero.thrust_allocation gives '
        '(-0.2, -40.3, -10.0). The simulation uses the column; delete aero.thrust_allocation, so '
        'that the columns follow from position and axis, or compute new ones with lta cfd run.'
    )
    assert 'forward_right has a moment of (0.0, -40.0, 20.0) N cm' in right


def test_a_rotor_that_is_turned_is_told_by_its_direction():
    """By 30 degrees; (0.981, 0.011, -0.061) makes acos(0.855 / 0.983) = 29.6 with that axis."""
    (told,) = warned('rotors.forward_left.axis=[0.866, 0.5, 0] 1')
    assert told.startswith(
        'The rotor forward_left points along (0.87, 0.50, 0.00), but its column of '
        'aero.thrust_allocation pushes along (0.98, 0.01, -0.06), 30 degrees away.'
    )


@pytest.mark.parametrize(
    ('place', 'is_far'),
    # 5 % of 41 cm are 2.06 cm, and shipped columns are 0.36 cm off.
    [('[0, 11.5, -40]', False), ('[0, 12.5, -40]', True), ('[5, 10, -40]', False)],
)
def test_only_what_changes_the_lever_is_far(place, is_far):
    """Along its push a rotor may be moved: the column is that of before."""
    assert bool(warned(f'rotors.forward_left.position={place} cm')) == is_far


def test_without_columns_there_is_nothing_to_be_outdated(gtmab):
    wide = load_vehicle_variant('gtmab', WIDE).file
    bare = wide.model_copy(update={'aero': wide.aero.model_copy(update={'thrust_allocation': {}})})
    assert list(find_stale_columns(bare)) == []


def said(found):
    console = Console(width=1000, record=True, file=StringIO())
    show_difference(found, ('a', 'b'), console)
    return console.export_text()


def test_diff_says_which_columns_held_moved_rotors(gtmab):
    found = compare_vehicles(gtmab, load_vehicle_variant('gtmab', WIDE))
    (told,) = found.stale_aero_notes
    assert told.startswith(
        'These rotors were moved or turned, but their columns in aero.thrust_allocation are '
        'unchanged: forward_left, forward_right.'
    )
    assert found.consequences == []
    words = said(found)
    assert told in words
    assert 'No derived figure changes' not in words
    assert encode_difference(found)['warnings'] == [told]


def test_diff_is_silent_where_the_column_came_along(gtmab):
    column = 'aero.thrust_allocation.forward_left.moment=[0, -0.4, -0.2] m'
    found = compare_vehicles(gtmab, load_vehicle_variant('gtmab', [WIDE[0], column]))
    assert found.stale_aero_notes == []
    assert 'push_turn_right' in {item.figure.key for item in found.consequences}


def test_diff_says_that_the_drag_is_of_another_hull(gtmab):
    larger = ['hull.diameter=110 cm', 'hull.height=65.9 cm']
    (told,) = compare_vehicles(gtmab, load_vehicle_variant('gtmab', larger)).stale_aero_notes
    assert told == (
        'The shape or size of the hull has changed, but the drag in the aero block has not; '
        'compute it again with lta cfd run.'
    )
    drag = 'aero.quadratic_drag.force=[0.114, 0.111, 0.445] N s2/m2'
    assert (
        compare_vehicles(gtmab, load_vehicle_variant('gtmab', [*larger, drag])).stale_aero_notes
        == []
    )
    assert (
        compare_vehicles(
            gtmab, load_vehicle_variant('gtmab', ['hull.purity=95 %'])
        ).stale_aero_notes
        == []
    )


def test_a_column_that_pushes_nowhere_is_judged_by_its_moment(gtmab):
    """A jet that is lost on the hull has no direction to be compared."""
    column = gtmab.file.aero.thrust_allocation['forward_left']
    nothing = column.force.model_copy(update={'value': (0.0, 0.0, 0.0)})
    still = column.model_copy(update={'force': nothing})
    aero = gtmab.file.aero.model_copy(update={'thrust_allocation': {'forward_left': still}})
    assert list(find_stale_columns(gtmab.file.model_copy(update={'aero': aero}))) == []
