"""Values go into a vehicle file without disturbing the rest of it."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_config.vehicle_edit import format_inline, set_yaml_value
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


def test_a_value_is_replaced_and_nothing_else_moves():
    new = set_yaml_value(TEXT, ['effects', 'lag', 'up'], VALUE)
    line = '    up: ' + format_inline(VALUE) + '   # measured'
    assert new.splitlines() == [
        line if old.startswith('    up:') else old for old in TEXT.splitlines()
    ]


@pytest.mark.parametrize(
    ('way', 'line'),
    [
        (['effects', 'sag', 'x'], '  sag: {x: 5}'),
        (['effects', 'lag', 'more'], '    more: 5'),
        (['effects', 'drag', 'z'], '  drag: {x: 1, y: 2, z: 5}'),
        (['hull', 'more', 'z'], 'hull: {shape: sphere, size: {value: 1, unit: m}, more: {z: 5}}'),
        (['none', 'z'], 'none: {z: 5}'),
        (['empty', 'z'], 'empty: {z: 5}'),
        (['new', 'z'], 'new: {z: 5}'),
    ],
)
def test_what_is_new_stands_with_its_neighbours(way, line):
    new = set_yaml_value(TEXT, way, 5)
    wanted = yaml.safe_load(TEXT)
    here = wanted
    for key in way[:-1]:
        here[key] = here.get(key) or {}
        here = here[key]
    here[way[-1]] = 5
    assert yaml.safe_load(new) == wanted
    assert line in new.splitlines()
    assert [row for row in TEXT.splitlines() if row.lstrip().startswith('#')] == [
        row for row in new.splitlines() if row.lstrip().startswith('#')
    ]


def test_a_text_of_anchors_is_written_anew_and_says_the_same():
    text = 'a: &one {x: 1}\nb: *one\n'
    assert yaml.safe_load(set_yaml_value(text, ['b', 'x'], 2)) == {'a': {'x': 1}, 'b': {'x': 2}}


def test_there_is_no_place_within_a_value():
    with pytest.raises(BadInput, match="'x' cannot be set"):
        set_yaml_value(TEXT, ['name', 'x'], 1)


@given(
    key=st.sampled_from(['lag', 'drag', 'payload']),
    name=st.from_regex(r'[a-z]{1,8}', fullmatch=True),
    value=st.floats(allow_nan=False, allow_infinity=False),
    source=st.text(max_size=30),
)
def test_a_file_takes_any_number_and_words(key, name, value, source):
    told = {'value': value, 'unit': 's', 'source': source}
    back = yaml.safe_load(set_yaml_value(TEXT, ['effects', key, name], told))
    assert back['effects'][key][name] == told
    assert back['hull'] == yaml.safe_load(TEXT)['hull']
