# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Strict files: whatever stands in one, it is read exactly or refused in one sentence."""

import contextlib
from pathlib import Path
import string

from hypothesis import given
from hypothesis import strategies as st
from lta_config import files
from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, load_file, load_yaml, StrictModel
from lta_config.settings import setting, Settings
from pydantic import ValidationError
import pytest

# 10^9 values from nine lines: each alias stands for ten of the line above.
BOMB = 'a0: &a0 [x]\n' + ''.join(
    f'a{k}: &a{k} [{", ".join(10 * [f"*a{k - 1}"])}]\n' for k in range(1, 10)
)


class Gains(Settings):
    kp: float = setting(0.5, '1/s', 0.0, 2.0)
    """Proportional gain."""
    count: int = setting(3, low=1, fixed=True)
    """
    Terms, on
    two lines.
    """


class File(StrictModel):
    name: str
    gains: Gains = Gains()


@pytest.fixture
def write(tmp_path):
    def write(content: str | bytes) -> Path:
        path = tmp_path / 'x.yaml'
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def test_a_good_file(write):
    read = load_file(File, write('name: a\ngains: {kp: 1.5}\n'))
    assert (read.name, read.gains.kp, read.gains.count) == ('a', 1.5, 3)
    with pytest.raises(ValidationError):
        read.name = 'b'


@pytest.mark.parametrize(
    ('content', 'message'),
    [
        ('', 'is not a YAML mapping (key: value); compare it with a shipped file.'),
        ('[1]', 'is not a YAML mapping'),
        ('name: a\nname: b', "the key 'name' appears twice (lines 1 and 2); merge them."),
        ('name: a\ngains: {kp: 1, kp: 1}', "the key 'kp' appears twice (line 2); merge them."),
        ('{}', "the key 'name' is missing; add it."),
        ('nam: a', "the key 'name' is missing and 'nam' is not known; correct its spelling."),
        ('seeds: a', "the key 'name' is missing; add it."),  # of another kind of file
        ('name: a\nnam: b', "the key 'nam' is not known; remove it or correct its spelling."),
        ('name: a\ngains: {ki: 1.0}', "the key 'gains.ki' is not known"),
        ('name: 5', 'name is 5, but must be text.'),
        ('name: a\ngains: {kp: 2.5}', 'gains.kp is 2.5, but must be at most 2.'),
        ('name: a\ngains: {kp: .nan}', 'gains.kp is nan, but must be'),
        ('name: a\ngains: {kp: "1"}', "gains.kp is '1', but must be a number."),
        ('name: a\ngains: {count: 1.0}', 'gains.count is 1.0, but must be a whole number.'),
        ('name: a\ngains: {count: true}', 'gains.count is True, but must be a whole number'),
        ('name: [', 'is not valid YAML: '),
        ('name: !!python/name:os.system', 'is not valid YAML: could not determine a constructor'),
        ('? [a, b]\n: 1', "the key ['a', 'b'] is a list or mapping; use a single word"),
        ('name: 2024-13-45', 'is not valid YAML: month must be in 1..12.'),
        ('name: ' + 5000 * '1', 'has a number with more than 400 digits'),
        ('name: !!int 1' + 90_000 * ':59', 'has a number with more than 400 digits'),
        (100 * '[', 'is nested more than 50 levels deep; use fewer levels.'),
        (
            900_000 * '[',
            'is nested more than 50 levels deep; use fewer levels.',
        ),  # once a crash of libyaml
        (1_000_001 * ' ', 'is larger than 1000000 bytes'),
        ('name: &a [*a]', "uses the alias '*a' inside the value that it stands for"),
        ('name: *a', 'is not valid YAML: found undefined alias'),
        (BOMB, 'has more than 1000000 values after its aliases are expanded; use'),
        ('name: !!int ""', 'is not valid YAML: '),
        ('name: !!bool perhaps', 'is not valid YAML: '),
        ('name: !!timestamp noon', 'is not valid YAML: '),
        (
            'name: &a [1]\ngains: &a [*a]',
            "uses the alias '*a' inside the value that it stands for",
        ),
        (b'name: \xff', 'cannot be read: '),
        (b'name: \x00', 'is not valid YAML: unacceptable character'),
    ],
)
def test_a_bad_file_gets_one_sentence(write, content, message):
    path = write(content)
    with pytest.raises(BadInput) as caught:
        load_file(File, path)
    text = str(caught.value)
    assert message in text
    assert text.startswith(str(path))
    assert '\n' not in text
    assert text.endswith('.')


@given(st.text(string.printable, max_size=60))
def test_no_text_gets_past_but_as_data_or_bad_input(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / 'any.yaml'
    path.write_text(text, encoding='utf-8')
    with contextlib.suppress(BadInput):
        load_yaml(path)


def test_long_text_that_begins_with_a_number_is_no_number(write):
    about = '16 photodiodes, ' + 40 * 'each with its own gain '
    assert load_file(File, write(f'name: {about}')).name == about.strip()
    digits = 5000 * '1'
    assert load_file(File, write(f'name: "{digits}"')).name == digits


def test_what_is_not_a_file(tmp_path):
    with pytest.raises(BadInput, match=r'is not a regular file; give the path of a YAML file'):
        load_yaml(tmp_path)
    with pytest.raises(BadInput, match=r'cannot be read: '):
        load_yaml(tmp_path / 'none.yaml')


def test_names_are_shipped_files_and_paths_are_paths(tmp_path, monkeypatch):
    (tmp_path / 'vehicles').mkdir()
    for name in ('vehicles/b.yaml', 'vehicles/a.yaml', 'own.yaml'):
        (tmp_path / name).touch()
    monkeypatch.setattr(files, 'share_folder', lambda: tmp_path)
    monkeypatch.chdir(tmp_path)
    assert files.list_shipped_names('vehicles') == ['a', 'b']
    assert find_file('vehicle', 'a') == tmp_path / 'vehicles/a.yaml'
    assert find_file('vehicle', 'own.yaml') == Path('own.yaml')
    assert find_file('vehicle', 'vehicles/b.yaml') == Path('vehicles/b.yaml')
    for name in ('c', '', '..', 'A'):
        with pytest.raises(BadInput, match=r"^Unknown vehicle '.*'; known: a, b\.$"):
            find_file('vehicle', name)
    with pytest.raises(BadInput, match=r"^No vehicle 'own' is shipped.*give './own.yaml'\.$"):
        find_file('vehicle', 'own')
    for name in ('no.yaml', './a', '/', '~nobody-at-all/x.yaml'):
        with pytest.raises(BadInput, match=r'^There is no vehicle file .*; check the path\.$'):
            find_file('vehicle', name)


def test_the_data_is_found():
    assert (files.share_folder() / 'topics.yaml').is_file()


def test_unknown_names_the_known():
    assert str(unknown_name_error('wind', 'x', ['b', 'a'])) == "Unknown wind 'x'; known: a, b."
    assert str(unknown_name_error('wind', 'x', [])) == "Unknown wind 'x'; known: none."
    meant = "Unknown wind 'outdoor'; known: indoors, outdoors (did you mean 'outdoors'?)."
    assert str(unknown_name_error('wind', 'outdoor', ['indoors', 'outdoors'])) == meant


def test_a_default_outside_its_bounds_is_a_mistake():
    class Wrong(Settings):
        kp: float = setting(3.0, high=2.0)

    with pytest.raises(ValidationError, match='less than or equal to 2'):
        Wrong()


def test_a_setting_carries_what_a_parameter_needs():
    info = Gains.model_fields['kp']
    assert info.description == 'Proportional gain.'
    assert info.json_schema_extra == {'unit': '1/s', 'read_only': False}
    assert Gains.model_fields['count'].json_schema_extra == {'unit': '', 'read_only': True}
    assert Gains.model_fields['count'].description == 'Terms, on two lines.'
    assert (Gains(kp=0.0).kp, Gains(kp=2.0).kp) == (0.0, 2.0)
