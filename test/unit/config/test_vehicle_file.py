"""The vehicle file: GT-MAB says where every number is from, and each mistake is one sentence."""

import copy
import math

from lta_config.errors import BadInput
from lta_config.files import find, known, load_yaml
from lta_config.vehicle_file import load_vehicle_file
import pytest
import yaml

GTMAB = load_yaml(find('vehicle', 'gtmab'))
BATTERY = 'layers.propulsion_and_control.battery'


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
    elif isinstance(content, list):
        for index, value in enumerate(content):
            yield from numbers(value, f'{place}.{index}')
    elif not isinstance(content, str | bool):
        yield place, content


@pytest.mark.parametrize('name', known('vehicles'))
def test_every_number_of_a_platform_has_unit_and_source(name):
    content = load_yaml(find('vehicle', name))
    assert content['name'] == name
    found = dict(numbers(content))
    assert len(found) > 40
    # A count and the version of the format are no measurements.
    bare = {place for place, given in found.items() if not isinstance(given, dict)}
    counts = {'schema', 'sensors.diodes.count', 'energy.array.series', 'energy.array.parallel'}
    assert bare == counts & found.keys()
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
            'the file has no parts in layers and was not measured as a whole; add either.',
        ),
        ('schema', 4, 'schema is 4, but must be 3.'),
        ('name', 'GT MAB', "name is 'GT MAB', but must match ^[a-z][a-z0-9_]*$."),
        (
            f'{BATTERY}.mass',
            {'value': 7, 'source': 'x'},
            f'{BATTERY}.mass has no unit; add "unit: ...".',
        ),
        (
            f'{BATTERY}.mass',
            7,
            f'{BATTERY}.mass 7 has no unit; write for example "7 kg".',
        ),
        (
            f'{BATTERY}.mass',
            '7 g',
            f'{BATTERY}.mass has no source; add "source: ..." (measured, datasheet, assumed...).',
        ),
        (
            f'{BATTERY}.mass',
            grams(7, source=''),
            f'{BATTERY}.mass has no source; add',
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
            f'{BATTERY}.mass is in cm, but must be in kg or its like.',
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


def test_a_column_must_be_of_a_rotor(tmp_path):
    columns = {
        ('tail' if name == 'forward_right' else name): column
        for name, column in GTMAB['aero']['thrust_allocation'].items()
    }
    assert refused(tmp_path, ('aero.thrust_allocation', columns)) == (
        'the file has no rotor tail, which aero.thrust_allocation names; rotors: up_left, '
        'up_right, forward_left, forward_right.'
    )


def test_jets_that_meet_must_be_of_rotors(tmp_path):
    jets = {
        'rotors': ['up_left', 'up_middle'],
        'force': given([0, 0, 1], 'N/N'),
        'moment': given([0, 0, 0], 'm'),
    }
    assert refused(tmp_path, ('aero.coupling', jets)).startswith(
        'the file has no rotor up_middle, which aero.coupling names; rotors: up_left, '
    )


def given(value, unit):
    return {'value': value, 'unit': unit, 'source': 'test'}


def without(content, *keys):
    return {key: value for key, value in content.items() if key not in keys}


TRIM = GTMAB['trim']


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        (
            {'hull': {'shape': 'sphere', 'diameter': given(1, 'm')}},
            'hull has the shape sphere, which needs purity; add it.',
        ),
        (
            {'hull.length': given(1, 'm')},
            'hull has the shape balloon, which has no length; remove it.',
        ),
        ({'hull.shape': 'cube'}, "hull.shape is 'cube', but must be 'balloon', 'spheroid', "),
        (
            {'layers.ballast': {'battery': GTMAB['layers']['hull']['envelope']}},
            'the file names the part battery in the layers propulsion_and_control and ballast; '
            'give one another name.',
        ),
        (
            {'rotors.up_left.axis': given([0, 0, 0.5], '1')},
            'rotors.up_left has an axis of length 0.5; divide it by that.',
        ),
        (
            {'rotors.up_left.thrust_curve': GTMAB['thrust_curve'] | {'reverse': given(1, 'N')}},
            'rotors.up_left has a thrust in reverse but is not reversible; remove one.',
        ),
        ({'thrust_curve': None}, 'the file has no thrust_curve for up_left, up_right, forward_l'),
        (
            {'rotors': {f'r{i}': GTMAB['rotors']['up_left'] for i in range(9)}},
            'rotors must have at most 8 of its kind.',
        ),
        (
            {'trim': without(TRIM, 'ballast_position')},
            'the file has a trim without heaviness and ballast_position; add both, or',
        ),
        (
            {'trim': {'ballast': 'none', 'heaviness': TRIM['heaviness']}},
            'the file has trim.ballast none and a trim.heaviness, which only ballast could',
        ),
        (
            {'trim.ballast': 'none'},
            'the file has trim.ballast none and a trim.ballast_position; remove one.',
        ),
        (
            {
                'measured': {
                    'mass': given(1, 'kg'),
                    'position': given([0, 0, -1], 'cm'),
                    'inertia': given([1, 1, 1], 'kg m2'),
                }
            },
            'the file is weighed as a whole (measured) and has a trim.ballast_position; ballast',
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
            'moving_mass starts outside its travel; put position between low and high.',
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
            'sensors.diodes has 4 axes for 8 diodes; give each diode one.',
        ),
        (
            [(f'{RING}.axes', {'value': [[1.0, 1.0, 0.0]] * 8, 'source': 'test'})],
            'sensors.diodes.axes has an axis of length 1.41 for the diode 0; divide it by that.',
        ),
        (
            [(f'{RING}.axes', {'value': [[math.nan, 1.0, 0.0]] * 8, 'source': 'test'})],
            'sensors.diodes.axes has an axis of length nan for the diode 0; divide it by that.',
        ),
        (
            [(f'{RING}.dead', [8])],
            'sensors.diodes names the dead diode 8, but has 8, counted from 0; correct the '
            'number.',
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


FLAT = {
    'capacity': {'value': 250, 'unit': 'mA h', 'source': 'test'},
    'resistance': {'value': 0.15, 'unit': 'ohm', 'source': 'test'},
    'idle': {'value': 97, 'unit': 'mW', 'source': 'test'},
    'transmitting': {'value': 23, 'unit': 'mW', 'source': 'test'},
    'rotor_idle': {'value': 27, 'unit': 'mW', 'source': 'test'},
    'rotor_power': {'value': 23.96, 'unit': 'W/N', 'source': 'test'},
    'panel_area': {'value': 139, 'unit': 'cm2', 'source': 'test'},
    'panel_efficiency': {'value': 20, 'unit': '%', 'source': 'test'},
    'panel_voltage': {'value': 4.4, 'unit': 'V', 'source': 'test'},
}


def version_2():
    """Return GT-MAB as version 2 of the format had it."""
    old = copy.deepcopy(GTMAB) | {'schema': 2, 'energy': copy.deepcopy(FLAT)}
    old['sensors']['panel_position'] = copy.deepcopy(
        old['layers']['top']['solar_panels']['position']
    )
    return old


def test_version_2_is_read(tmp_path):
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(version_2(), sort_keys=False))
    old, new = load_vehicle_file(str(path)), load_vehicle_file('gtmab')
    assert old.parts == new.parts
    assert old.panel_place == new.panel_place == (0.0, 0.0, 0.302)
    assert old.panel_normal == new.panel_normal == (0.0, 0.0, 1.0)
    energy = old.energy
    assert (energy.battery.capacity.si, energy.battery.resistance.si) == (900.0, 0.15)
    assert energy.battery.relaxation_resistance.si == 0.0
    assert energy.battery.charge_current.si == pytest.approx(0.25)  # 1 C
    assert energy.loads.rotor_power.si == 23.96
    # 139 cm2 of 20 % give 2.78 W in 1000 W/m2, and so do 139 cells of 1 cm2.
    assert energy.array.parallel == 139
    assert energy.array.parallel * energy.array.cell_file.rated == pytest.approx(2.78)
    assert (energy.charger.tracking.si, energy.charger.idle.si) == (1.0, 0.0)


def test_version_2_without_a_panel_has_none(tmp_path):
    old = version_2()
    old['energy']['panel_area']['value'] = 0
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(old, sort_keys=False))
    energy = load_vehicle_file(str(path)).energy
    assert energy.array is None
    assert energy.charger is None


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        (
            [('energy.array.part', 'sail')],
            'has no part sail, which energy.array.part names; parts: envelope, ',
        ),
        ([('energy.array.part', None)], 'needs the place of its panel once: either '),
        ([('energy.charger', None)], 'energy has an array and no charger; add it, or remove'),
        ([('energy.array.cell', 'duracell')], "Unknown cell 'duracell'; known: adafruit, "),
        ([('energy.array.normal.value', [0, 0, 2])], 'energy.array.normal is [0, 0, 2]'),
        ([('energy.array.normal.value', [0, 0, 0.5])], 'has a normal of length 0.5; divide'),
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


def version_1():
    """Return GT-MAB as version 1 of the format had it."""
    old = version_2() | {'schema': 1}
    old['parts'] = {n: part for layer in old.pop('layers').values() for n, part in layer.items()}
    del old['hull']['shape'], old['control']
    for rotor in old['rotors'].values():
        del rotor['axis']
    return old


def test_version_1_is_read(tmp_path):
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(version_1(), sort_keys=False))
    old, new = load_vehicle_file(str(path)), load_vehicle_file('gtmab')
    assert old.parts == new.parts
    assert list(old.parts) == list(new.parts)
    for name, rotor in new.rotors.items():
        assert old.rotors[name].axis.vector == rotor.axis.vector
        assert old.rotors[name].position == rotor.position
    for key in ('trim', 'hull', 'thrust_curve', 'aero', 'effects'):
        assert getattr(old, key) == getattr(new, key)


def test_a_broken_version_1_is_one_sentence(tmp_path):
    path = tmp_path / 'old.yaml'
    for key, words in (('hull', "'hull' is missing"), ('aero', "'aero' is missing")):
        path.write_text(yaml.safe_dump(without(version_1(), key)))
        with pytest.raises(BadInput, match=words):
            load_vehicle_file(str(path))
    old = version_1()
    del old['aero']['thrust_allocation']['up_left']
    path.write_text(yaml.safe_dump(old))
    with pytest.raises(
        BadInput, match=r'has no column of aero\.thrust_allocation for up_left; add'
    ):
        load_vehicle_file(str(path))


def test_an_unknown_vehicle_lists_the_known_ones():
    with pytest.raises(BadInput) as caught:
        load_vehicle_file('gtmap')
    assert str(caught.value) == (
        "Unknown vehicle 'gtmap'; known: beavis, blimp2b, gtmab, multirotor, rgblimp, sblimp, "
        'skye.'
    )
