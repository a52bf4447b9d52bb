"""The vehicle file: GT-MAB says where every number is from, and each mistake is one sentence."""

import copy
import math

from lta_config.errors import BadInput
from lta_config.files import find, load_yaml
from lta_config.vehicle_file import load_vehicle_file
import pytest
import yaml

GTMAB = load_yaml(find('vehicle', 'gtmab'))


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


def numbers(content, place=''):
    """Walk over everything that is or holds a number: (place, what stands there)."""
    if isinstance(content, dict) and 'value' in content:
        yield place, content
    elif isinstance(content, dict):
        for key, value in content.items():
            yield from numbers(value, f'{place}.{key}'.lstrip('.'))
    elif not isinstance(content, str | bool):
        yield place, content


def test_every_number_of_gtmab_has_unit_and_source():
    found = dict(numbers(GTMAB))
    assert len(found) > 80
    # A count and the version of the format are no measurements.
    bare = {place for place, given in found.items() if not isinstance(given, dict)}
    assert bare == {'schema', 'sensors.diodes.count'}
    for place, given in found.items():
        if isinstance(given, dict):
            assert given['unit'], place
            assert len(given['source'].strip()) >= 4, place


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
        ('parts.battery.mess', 1, "the key 'parts.battery.mess' is not known; remove it or"),
        ('hull', None, "the key 'hull' is missing; add it."),
        ('parts.battery.mass', None, "the key 'parts.battery.mass' is missing; add it."),
        ('parts', {}, 'parts must have at least 1 of its kind.'),
        ('schema', 2, 'schema is 2, but must be 1.'),
        ('name', 'GT MAB', "name is 'GT MAB', but must match ^[a-z][a-z0-9_]*$."),
        (
            'parts.battery.mass',
            {'value': 7, 'source': 'x'},
            'parts.battery.mass has no unit; add "unit: ...".',
        ),
        ('parts.battery.mass', 7, 'parts.battery.mass 7 has no unit; write for example "7 kg".'),
        (
            'parts.battery.mass',
            '7 g',
            'parts.battery.mass has no source; add "source: ..." (measured, datasheet, '
            'assumed...).',
        ),
        ('parts.battery.mass', grams(7, source=''), 'parts.battery.mass has no source; add'),
        (
            'parts.battery.mass',
            grams(-7),
            'parts.battery.mass is -7 g, but must be above 0 and at most 100000 g.',
        ),
        (
            'parts.battery.mass',
            grams(0),
            'parts.battery.mass is 0 g, but must be above 0 and at most 100000 g.',
        ),
        (
            'parts.battery.mass',
            grams(1e9),
            'parts.battery.mass is 1000000000 g, but must be above 0 and at most 100000 g.',
        ),
        (
            'parts.battery.mass',
            grams(math.nan),
            'parts.battery.mass is nan, which is not a finite number.',
        ),
        (
            'parts.battery.mass',
            grams(math.inf),
            'parts.battery.mass is inf, which is not a finite number.',
        ),
        (
            'parts.battery.mass',
            grams(7, unit='cm'),
            'parts.battery.mass is in cm, but must be in kg or its like.',
        ),
        (
            'parts.battery.mass',
            grams([7, 8]),
            'parts.battery.mass has 2 numbers, but needs 1.',
        ),
        (
            'parts.battery.position',
            grams([0, 1], unit='cm'),
            'parts.battery.position has 2 numbers, but needs 3.',
        ),
        (
            'parts.battery.position',
            grams([0, 0, 21], unit='m'),
            'parts.battery.position is [0, 0, 21] m, but must be from -20 to 20 m.',
        ),
        (
            'parts.battery.shape',
            'sphere',
            "parts.battery.shape is 'sphere', but must be 'shell' or 'box'.",
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
            'aero.linear_drag.moment is in N m s2, but must be in N m s or its like.',
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
            'effects.motor_lag.up 72 has no unit; write it behind the number, as in "7 m".',
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


def test_rotors_and_columns_must_have_the_same_names(tmp_path):
    columns = {
        ('tail' if name == 'forward_right' else name): column
        for name, column in GTMAB['aero']['thrust_allocation'].items()
    }
    assert refused(tmp_path, ('aero.thrust_allocation', columns)) == (
        'the file names the rotors up_left, up_right, forward_left, forward_right but the columns '
        'of thrust_allocation up_left, up_right, forward_left, tail; use the same names in the '
        'same order.'
    )


def test_rotors_and_columns_must_have_the_same_order(tmp_path):
    columns = dict(reversed(GTMAB['aero']['thrust_allocation'].items()))
    assert 'same order' in refused(tmp_path, ('aero.thrust_allocation', columns))


def test_a_missing_column_is_found(tmp_path):
    assert 'same names' in refused(tmp_path, ('aero.thrust_allocation.up_left', None))


def test_an_unknown_vehicle_lists_the_known_ones():
    with pytest.raises(BadInput) as caught:
        load_vehicle_file('gtmap')
    assert str(caught.value) == "Unknown vehicle 'gtmap'; known: gtmab."
