"""The constants in docs/discovery.md are those of the code."""

from importlib import import_module
from pathlib import Path
import re

from lta_analysis.discovery.finding import Finding
from lta_analysis.discovery.results.discovery_json import to_dict
import pytest

PAGE = Path(__file__).resolve().parents[2] / 'docs/discovery.md'
ROW = re.compile(r'^\| ([^|]+) \| ([\d.]+)[^|]* \| `([\w.]+)\.([A-Z_]+)` \|$', re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text(encoding='utf-8'))


def test_the_page_has_a_table_of_constants():
    assert len(ROWS) > 15
    assert len({row[2:] for row in ROWS}) == len(ROWS)


@pytest.mark.parametrize(('what', 'value', 'module', 'name'), ROWS, ids=lambda part: part)
def test_a_constant_is_declared_where_the_page_says(what, value, module, name):
    declared = getattr(import_module(f'lta_analysis.discovery.{module}'), name)
    assert declared == float(value), what


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
