"""The vehicle file: GT-MAB says where every number is from, and each mistake is one sentence."""

import math

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest

from .changed_vehicle import given, GTMAB, refused

BATTERY = 'layers.propulsion_and_control.battery'


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


def test_another_version_of_the_file_is_refused(tmp_path):
    assert refused(tmp_path, ('schema', 2)) == 'schema is 2, but must be 3.'


def test_sources_are_kept():
    file = load_vehicle_file('gtmab')
    assert file.parts['battery'].mass.source == 'seed paper, 1S 250 mAh'
    assert file.parts['battery'].mass.si == pytest.approx(0.007)


def grams(value, **more):
    return {'value': value, 'unit': 'g', 'source': 'test'} | more


@pytest.mark.parametrize(
    ('place', 'value', 'sentence'),
    [
        ('colour', 'red', "the key 'colour' is not known; remove it or correct its spelling."),
        ('hull.weight', 'x', "the key 'hull.weight' is not known; remove it or correct its"),
        (
            f'{BATTERY}.mess',
            1,
            f"the key '{BATTERY}.mess' is not known; remove it or",
        ),
        ('hull', None, "the key 'hull' is missing; add it."),
        (
            f'{BATTERY}.mass',
            None,
            f"the key '{BATTERY}.mass' is missing; add it.",
        ),
        (
            'layers',
            {},
            'the file has neither parts in "layers" nor a mass of the whole vehicle in '
            '"measured"; ',
        ),
        ('schema', 4, 'schema is 4, but must be 3.'),
        ('name', 'GT MAB', "name is 'GT MAB', but must match ^[a-z][a-z0-9_]*$."),
        (
            f'{BATTERY}.mass',
            {'value': 7, 'source': 'x'},
            f'{BATTERY}.mass has no unit; add one, as in "unit: m".',
        ),
        (
            f'{BATTERY}.mass',
            7,
            f'{BATTERY}.mass is 7 and has no unit; write for example "7 kg".',
        ),
        (
            f'{BATTERY}.mass',
            '7 g',
            f'{BATTERY}.mass has no source; state where the value comes from, as in "source: ',
        ),
        (
            f'{BATTERY}.mass',
            grams(7, source=''),
            f'{BATTERY}.mass has no source; state',
        ),
        (
            f'{BATTERY}.mass',
            grams(-7),
            f'{BATTERY}.mass is -7 g, but must be above 0 and at most 100000 g.',
        ),
        (
            f'{BATTERY}.mass',
            grams(0),
            f'{BATTERY}.mass is 0 g, but must be above 0 and at most 100000 g.',
        ),
        (
            f'{BATTERY}.mass',
            grams(1e9),
            f'{BATTERY}.mass is 1000000000 g, but must be above 0 and at most 100000 g.',
        ),
        (
            f'{BATTERY}.mass',
            grams(math.nan),
            f'{BATTERY}.mass is nan, which is not a finite number.',
        ),
        (
            f'{BATTERY}.mass',
            grams(math.inf),
            f'{BATTERY}.mass is inf, which is not a finite number.',
        ),
        (
            f'{BATTERY}.mass',
            grams(7, unit='cm'),
            f'{BATTERY}.mass is in cm, but must be in kg or a compatible unit.',
        ),
        (
            f'{BATTERY}.mass',
            grams([7, 8]),
            f'{BATTERY}.mass has 2 numbers, but needs 1.',
        ),
        (
            f'{BATTERY}.position',
            grams([0, 1], unit='cm'),
            f'{BATTERY}.position has 2 numbers, but needs 3.',
        ),
        (
            f'{BATTERY}.position',
            grams([0, 0, 21], unit='m'),
            f'{BATTERY}.position is [0, 0, 21] m, but must be from -20 to 20 m.',
        ),
        (
            f'{BATTERY}.shape',
            'sphere',
            f"{BATTERY}.shape is 'sphere', but must be 'shell' or 'box'.",
        ),
        (
            'hull.purity',
            grams(101, unit='%'),
            'hull.purity is 101 %, but must be from 0 to',
        ),
        (
            'aero.quadratic_drag.force',
            grams([0.1, -0.1, 0.3], unit='N s2/m2'),
            'aero.quadratic_drag.force is [0.1, -0.1, 0.3] N s2/m2, but must be at least 0 N',
        ),
        (
            'aero.linear_drag.moment',
            grams([1, 1, 1], unit='N m s2'),
            'aero.linear_drag.moment is in N m s2, but must be in N m s or a compatible unit.',
        ),
        ('thrust_curve.b', grams(0, unit='N'), 'thrust_curve.b is 0 N, but must be above 0 N.'),
        ('sensors.diodes.count', 0, 'sensors.diodes.count is 0, but must be at least 1.'),
        ('sensors.diodes.count', 8.0, 'sensors.diodes.count is 8.0, but must be a whole number.'),
        (
            'rotors.up_left.reversible',
            'no',
            "rotors.up_left.reversible is 'no', but must be true or false.",
        ),
        (
            'effects.motor_lag.up',
            72,
            'effects.motor_lag.up is 72 and has no unit; add one, as in "7 m".',
        ),
        (
            'effects.motor_lag.up',
            grams(72, unit='furlong'),
            'effects.motor_lag.up has the unknown unit "furlong"; known: 1, %, m, cm',
        ),
    ],
)
def test_a_mistake_is_one_sentence(tmp_path, place, value, sentence):
    text = refused(tmp_path, (place, value))
    assert text.startswith(sentence)
    assert '\n' not in text
    assert text.endswith('.')


def test_a_column_must_be_of_a_rotor(tmp_path):
    columns = {
        ('tail' if name == 'forward_right' else name): column
        for name, column in GTMAB['aero']['thrust_allocation'].items()
    }
    assert refused(tmp_path, ('aero.thrust_allocation', columns)) == (
        'the file uses tail in aero.thrust_allocation, but has no such rotor; rotors: up_left, '
        'up_right, forward_left, forward_right.'
    )


def test_jets_that_meet_must_be_of_rotors(tmp_path):
    jets = {
        'rotors': ['up_left', 'up_middle'],
        'force': given([0, 0, 1], 'N/N'),
        'moment': given([0, 0, 0], 'm'),
    }
    assert refused(tmp_path, ('aero.coupling', jets)).startswith(
        'the file uses up_middle in aero.coupling, but has no such rotor; rotors: up_left, '
    )


def test_an_unknown_vehicle_lists_the_known_ones():
    with pytest.raises(BadInput) as caught:
        load_vehicle_file('gtmap')
    shipped = ', '.join(list_shipped_names('vehicles'))
    assert str(caught.value) == (
        f"Unknown vehicle 'gtmap'; known: {shipped} (did you mean 'gtmab'?)."
    )
