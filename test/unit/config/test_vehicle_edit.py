# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Values go into a vehicle file without disturbing the rest of it."""

import difflib
import re

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names
from lta_config.vehicle_edit import format_yaml, set_yaml_values
import pytest
import yaml

TEXT = """\
# what it is
name: one   # its name
hull: {shape: sphere, size: {value: 1, unit: m}}
effects:
  # those that are on
  lag:
    up: 70 ms   # measured
    down: 80 ms
  drag: {x: 1, y: 2}

  # the last word of the block

rest: [1, 2]
empty:
none: {}
"""
VALUE = {'value': 0.5, 'unit': 's', 'source': 'it, "so"'}


def changed_lines(old, new):
    """Return the lines that are not in both texts, in order."""
    differ = difflib.ndiff(old.splitlines(), new.splitlines())
    return [line for line in differ if line[0] in '+-']


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_a_number_of_a_shipped_file_is_one_line(name):
    text = find_file('vehicle', name).read_text(encoding='utf-8')
    assert set_yaml_values(text, {}) == text
    places = list(quantities(yaml.safe_load(text)))
    assert len(places) > 40
    new = set_yaml_values(text, {f'{place}.source': 'a scale' for place in places})
    pairs = list(zip(text.splitlines(), new.splitlines(), strict=True))
    rows = [row for old, row in pairs if old != row]
    assert sum(len(re.findall(r'source: "?a scale"?', row)) for row in rows) == len(places)
    first = set_yaml_values(text, {f'{places[0]}.value': 5})
    assert [line[:1] for line in changed_lines(text, first)] == ['-', '+']


def quantities(content, place=''):
    """Yield the places of all quantities."""
    for key, value in content.items():
        if isinstance(value, dict) and 'unit' in value:
            yield f'{place}{key}'
        elif isinstance(value, dict):
            yield from quantities(value, f'{place}{key}.')


def test_a_value_is_replaced_and_nothing_else_moves():
    new = set_yaml_values(TEXT, {'effects.lag.up': VALUE})
    assert changed_lines(TEXT, new) == [
        '-     up: 70 ms   # measured',
        """+     up: {value: 0.5, unit: s, source: 'it, "so"'} # measured""",
    ]


@pytest.mark.parametrize(
    ('place', 'line'),
    [
        ('effects.sag.x', '  sag: {x: 5}'),
        ('effects.sag.x.y', '    x: {y: 5}'),
        ('effects.lag.more', '    more: 5'),
        ('effects.drag.z', '  drag: {x: 1, y: 2, z: 5}'),
        ('hull.more.z', 'hull: {shape: sphere, size: {value: 1, unit: m}, more: {z: 5}}'),
        ('none.z', '  z: 5'),
        ('empty.z', 'empty: {z: 5}'),
        ('new.z', 'new: {z: 5}'),
        ('effects.lag', '  lag: 5'),
    ],
)
def test_what_is_new_stands_with_its_neighbours(place, line):
    new = set_yaml_values(TEXT, {place: 5})
    wanted = yaml.safe_load(TEXT)
    here, (*way, last) = wanted, place.split('.')
    for key in way:
        here[key] = here.get(key) or {}
        here = here[key]
    here[last] = 5
    assert yaml.safe_load(new) == wanted
    assert line in new.splitlines()
    assert [row for row in TEXT.splitlines() if row.lstrip().startswith('#')] == [
        row for row in new.splitlines() if row.lstrip().startswith('#')
    ]


def test_a_block_is_replaced_and_the_comment_below_it_stays():
    new = set_yaml_values(TEXT, {'effects': {'terms': [{'a': 1}, {'b': [1, 2]}]}})
    head, _, tail = new.partition('  terms:\n  - {a: 1}\n  - {b: [1, 2]}\n')
    assert head.endswith('effects:\n  # those that are on\n')
    assert tail == TEXT[TEXT.index('\n  # the last word') :]
    assert set_yaml_values(new, {'effects': {'x': 1}}).endswith(f'effects: {{x: 1}}\n{tail}')


@pytest.mark.parametrize(('place', 'a', 'b'), [('a.x', 2, 1), ('b.x', 1, 2)])
def test_of_two_that_share_an_anchor_only_one_changes(place, a, b):
    text = set_yaml_values('a: &one {x: 1}\nb: *one\n', {place: 2})
    assert yaml.safe_load(text) == {'a': {'x': a}, 'b': {'x': b}}


def test_what_two_places_share_is_written_twice_and_without_anchors():
    curve = {'a': VALUE, 'b': VALUE}
    text = format_yaml({'left': {'curve': curve}, 'right': {'curve': curve}})
    assert yaml.safe_load(text)['right'] == {'curve': curve}
    assert '&' not in text
    assert text.count('    a: {value: 0.5, unit: s, source: \'it, "so"\'}\n') == 2


def test_numbers_and_words_are_read_as_before():
    odd = 'a: [1.0e-05, 1e-3, 1.50, +1, .5, 010, yes, ~, 1_000, 0x10, 12:30, 1.0e+3, -.inf, "1"]\n'
    assert yaml.safe_load(set_yaml_values(odd, {'b': 'no'})) == yaml.safe_load(odd) | {'b': 'no'}


def test_there_is_no_place_within_a_value():
    with pytest.raises(BadInput, match="'x' cannot be set"):
        set_yaml_values(TEXT, {'name.x': 1})


@given(
    key=st.sampled_from(['lag', 'drag', 'payload']),
    name=st.from_regex(r'[a-z]{1,8}', fullmatch=True),
    value=st.floats(allow_nan=False, allow_infinity=False),
    # A NEL, which YAML 1.1 reads as an end of line, is kept by ruamel.yaml as it is
    source=st.text(st.characters(codec='utf-8', exclude_characters='\x85'), max_size=30),
)
def test_a_file_takes_any_number_and_words(key, name, value, source):
    told = {'value': value, 'unit': 's', 'source': source}
    back = yaml.safe_load(set_yaml_values(TEXT, {f'effects.{key}.{name}': told}))
    assert back['effects'][key][name] == told
    assert back['hull'] == yaml.safe_load(TEXT)['hull']
