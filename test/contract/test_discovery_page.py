"""The pages about discovery say what the code has."""

from importlib import import_module
from pathlib import Path
import re

from lta_analysis.discovery.finding import Finding
from lta_analysis.discovery.results.discovery_json import to_dict
from lta_analysis.reference.thresholds import list_thresholds
import pytest

PAGE = Path(__file__).resolve().parents[2] / 'docs/discovery.md'


def test_every_threshold_says_what_it_is():
    every = list(list_thresholds())
    assert len(every) > 200
    assert len({one.key for one in every}) == len(every)
    assert [one.key for one in every if not one.about] == []


def test_the_values_of_the_page_are_those_that_the_code_uses():
    for one in list_thresholds():
        used = getattr(import_module(f'lta_analysis.discovery.{one.module}'), one.name)
        base, _, power = one.value.partition('**')
        assert used == pytest.approx(float(base) ** float(power or 1.0)), one.key


def test_a_file_that_the_page_names_is_there():
    text = PAGE.read_text(encoding='utf-8')
    folder = Path(import_module('lta_analysis.discovery').__file__).parent
    named = set(re.findall(r'`([\w/]+\.py)`', text))
    assert 'model/knobs.py' in named
    assert sorted(name for name in named if not (folder / name).exists()) == []


def test_the_page_lists_the_keys_of_the_result():
    text = PAGE.read_text(encoding='utf-8')
    table = text[text.index('`discovery.json`:') : text.index('## The demonstration')]
    listed = re.findall(r'^\| (`[^|]+) \|', table, re.MULTILINE)
    nothing = Finding('none', (), (), (), (), False, (), (), 1, {}, 'gtmab')
    assert {key.strip('`') for row in listed for key in row.split(', ')} == set(to_dict(nothing))
