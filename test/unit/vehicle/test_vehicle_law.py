"""What commands on vehicle files make of a law."""

import json
from pathlib import Path

from lta_config.files import find_file
from lta_config.schema.vehicle_law import Law
from lta_config.vehicle_edit import set_yaml_values
import pytest

BLOCK = {
    'source': 'a test',
    'terms': [
        {
            'axis': 'yaw',
            'coefficient': -3.1e-4,
            'unit': 'N s2',
            'factors': [{'quantity': 'speed'}, {'quantity': 'r'}],
            'interval': [-3.5e-4, -2.7e-4],
            'evidence': 12.5,
        }
    ],
    'region': {'speed': [0.0, 0.6], 'r': [-1.0, 1.0]},
}


@pytest.fixture
def lawful(tmp_path):
    """Return the path of GT-MAB's file with a law."""
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    path = tmp_path / 'lawful.yaml'
    path.write_text(
        set_yaml_values(
            text, {'law': Law.model_validate(BLOCK).model_dump(exclude_defaults=True)}
        ),
        encoding='utf-8',
    )
    return str(path)


def test_show_prints_the_formula_and_lists_the_coefficient(call, lawful):
    status, output = call('vehicle', 'show', lawful, '--json')
    assert status == 0
    shown = json.loads(output.out)
    assert (
        'A law without a name acts: yaw moment [N m] = -0.00031 speed r; for speed 0 to 0.6 m/s, '
        'r -1 to 1 rad/s; outside, it fades to zero.'
    ) in shown['words']
    (entry,) = [one for one in shown['numbers'] if one['place'].startswith('law.')]
    assert entry == {
        'place': 'law.terms.1.coefficient',
        'value': -3.1e-4,
        'unit': 'N s2',
        'written': '-0.00031 N s2, 95 % -0.00035 to -0.00027, 12.5 nats',
        'source': 'a test',
        'assumed': False,
    }


def test_diff_lists_what_the_law_adds(call, lawful):
    status, output = call('vehicle', 'diff', 'gtmab', lawful, '--json')
    assert status == 0
    changes = {one['place']: one['after']['written'] for one in json.loads(output.out)['changes']}
    assert changes == {
        'law.yaw': 'yaw moment [N m] = -0.00031 speed r',
        'law.terms.1.coefficient': '-0.00031 N s2, 95 % -0.00035 to -0.00027, 12.5 nats',
        'law.region': 'speed 0 to 0.6 m/s, r -1 to 1 rad/s',
    }


def test_check_accepts_a_law_and_names_a_wrong_unit(call, lawful, tmp_path):
    status, output = call('vehicle', 'check', lawful)
    assert (status, 'is a valid vehicle file' in output.out) == (0, True)
    wrong = tmp_path / 'wrong.yaml'
    text = Path(lawful).read_text(encoding='utf-8')
    wrong.write_text(text.replace('unit: N s2,', 'unit: N m,'), encoding='utf-8')
    status, output = call('vehicle', 'check', str(wrong))
    assert status == 2
    assert 'law has the unit "N m" in term 1, but its axis and factors give "N s2"' in ' '.join(
        (output.out + output.err).split()
    )


def test_a_law_among_the_effects_is_refused(call, tmp_path):
    """Its numbers would be flown past all checks of the block law."""
    path = tmp_path / 'wrong.yaml'
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    given = {'axis_1': {'value': 1.0, 'unit': '1', 'source': 'a test'}}
    path.write_text(set_yaml_values(text, {'effects': {'law': given}}), encoding='utf-8')
    complaint = 'has law in its block effects, but a law is no effect with parameters; write it'
    for verb in (('vehicle', 'check'), ('vehicle', 'show')):
        status, output = call(*verb, str(path))
        assert status == 2
        assert complaint in ' '.join((output.out + output.err).split())


def test_a_skeleton_is_written_from_the_law(call, lawful, tmp_path):
    folder = tmp_path / 'new'
    status, output = call('effects', 'new', 'my_damping', '--from', lawful, '--out', str(folder))
    assert status == 0
    assert sorted(path.name for path in folder.iterdir()) == ['my_damping.py', 'pyproject.toml']
    assert 'yaw_1 * speed * rate_r' in (folder / 'my_damping.py').read_text(encoding='utf-8')
    status, output = call('effects', 'new', 'my_damping', '--from', 'gtmab')
    assert status == 2
    assert 'The vehicle file of gtmab has no law' in ' '.join((output.out + output.err).split())
