"""What of a vehicle file must go together: hull, trim, rotors, diodes, energy."""

import copy
import math

from lta_config.schema.vehicle_file import load_vehicle_file
import pytest
import yaml

from .changed_vehicle import given, GTMAB, put, refused, without

TRIM = GTMAB['trim']


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        (
            {'hull': {'shape': 'sphere', 'diameter': given(1, 'm')}},
            'hull has the shape sphere, but not its keys purity; add them.',
        ),
        (
            {'hull.length': given(1, 'm')},
            'hull has keys that the shape balloon does not use: length; remove them.',
        ),
        ({'hull.shape': 'cube'}, "hull.shape is 'cube', but must be 'balloon', 'spheroid', "),
        (
            {'layers.ballast': {'battery': GTMAB['layers']['hull']['envelope']}},
            'the file has a part battery in both layers propulsion_and_control and ballast, '
            'but part names must be unique; rename',
        ),
        (
            {'rotors.up_left.axis': given([0, 0, 0.5], '1')},
            'rotors.up_left has an axis of length 0.5, but needs a unit vector; divide it by its',
        ),
        (
            {'rotors.up_left.thrust_curve': GTMAB['thrust_curve'] | {'reverse': given(1, 'N')}},
            'rotors.up_left has thrust_curve.reverse, but is not reversible; remove thrust_curve',
        ),
        (
            {'thrust_curve': None},
            'the file has no thrust_curve for the rotors up_left, up_right, ',
        ),
        (
            {'rotors': {f'r{i}': GTMAB['rotors']['up_left'] for i in range(9)}},
            'rotors must have 8 or fewer entries.',
        ),
        (
            {'trim': without(TRIM, 'ballast_position')},
            'the file needs heaviness and ballast_position in "trim"; add both, or',
        ),
        (
            {'trim': {'ballast': 'none', 'heaviness': TRIM['heaviness']}},
            'the file has both "ballast: none" and heaviness in "trim", but heaviness needs',
        ),
        (
            {'trim.ballast': 'none'},
            'the file has both "ballast: none" and ballast_position in "trim"; remove one.',
        ),
        (
            {
                'measured': {
                    'mass': given(1, 'kg'),
                    'position': given([0, 0, -1], 'cm'),
                    'inertia': given([1, 1, 1], 'kg m2'),
                }
            },
            'the file has a mass of the whole vehicle in "measured", which includes the ballast',
        ),
        (
            {
                'moving_mass': {
                    'mass': given(1, 'g'),
                    'position': given([5, 0, 0], 'cm'),
                    'low': given([-1, 0, 0], 'cm'),
                    'high': given([1, 0, 0], 'cm'),
                    'time_constant': given(1, 's'),
                }
            },
            'moving_mass has a "position" outside the range from "low" to "high"; ',
        ),
    ],
)
def test_what_does_not_go_together_is_one_sentence(tmp_path, changes, sentence):
    assert refused(tmp_path, *changes.items()).startswith(sentence)


SQUARE = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
RING = 'sensors.diodes'


def test_diodes_may_look_anywhere(tmp_path):
    content = copy.deepcopy(GTMAB)
    put(content, f'{RING}.count', 4)
    put(content, f'{RING}.axes', {'value': SQUARE, 'source': 'test'})
    put(content, f'{RING}.dead', [2])
    path = tmp_path / 'vehicle.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    diodes = load_vehicle_file(str(path)).sensors.diodes
    assert diodes.axes.value == SQUARE
    assert diodes.dead == [2]
    assert (diodes.response.si, diodes.gain_spread.si) == (1.2, pytest.approx(0.02))
    assert diodes.bandwidth.si == 14e3


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        (
            [(f'{RING}.axes', {'value': SQUARE, 'source': 'test'})],
            'sensors.diodes has 4 axes for 8 diodes; give one for each diode.',
        ),
        (
            [(f'{RING}.axes', {'value': [[1.0, 1.0, 0.0]] * 8, 'source': 'test'})],
            'sensors.diodes.axes has an axis of length 1.41 for the diode 0, but needs a unit '
            'vector; divide it by its length.',
        ),
        (
            [(f'{RING}.axes', {'value': [[math.nan, 1.0, 0.0]] * 8, 'source': 'test'})],
            'sensors.diodes.axes has an axis of length nan for the diode 0, but needs a unit '
            'vector; divide it by its length.',
        ),
        (
            [(f'{RING}.dead', [8])],
            'sensors.diodes has the number 8 in "dead", but the diodes are numbered from 0 to 7; '
            'correct the number.',
        ),
        (
            [(f'{RING}.field_of_view', {'value': 181, 'unit': 'deg', 'source': 'test'})],
            'sensors.diodes.field_of_view is 181 deg, but must be above 0 and at most 180 deg.',
        ),
        ([(f'{RING}.bits', 17)], 'sensors.diodes.bits is 17, but must be at most 16.'),
    ],
)
def test_what_are_no_diodes_is_one_sentence(tmp_path, changes, sentence):
    assert refused(tmp_path, *changes) == sentence


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        (
            [('energy.array.part', 'sail')],
            'uses sail in energy.array.part, but has no such part; parts: envelope, ',
        ),
        ([('energy.array.part', None)], 'needs exactly one position of its solar panel; '),
        ([('energy.charger', None)], 'energy has "array" but no "charger"; add it, or remove'),
        ([('energy.array.cell', 'duracell')], "Unknown cell 'duracell'; known: adafruit, "),
        ([('energy.array.normal.value', [0, 0, 2])], 'energy.array.normal is [0, 0, 2]'),
        ([('energy.array.normal.value', [0, 0, 0.5])], 'has a normal of length 0.5, but needs'),
        ([('energy.array.series', 0)], 'energy.array.series is 0, but must be at least 1'),
        (
            [('energy.battery.discharge_cutoff.value', 4.3)],
            'has a discharge_cutoff of 4.3 V and a charge_cutoff of 4.2 V',
        ),
        ([('energy.battery.capacity.unit', 'g')], 'battery.capacity is in g, but must be in C'),
    ],
)
def test_what_is_no_energy_is_one_sentence(tmp_path, changes, sentence):
    assert sentence in refused(tmp_path, *changes)
