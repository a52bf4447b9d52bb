"""The pages about discovery say what the code has."""

import ast
from importlib import import_module
import math
from pathlib import Path
import re

from lta_cli.reference.thresholds import list_thresholds, PARTS, read_sources, SHAPES
from lta_discovery.finding import StudyResult
from lta_discovery.results.discovery_json import to_dict
import pytest

PAGE = Path(__file__).resolve().parents[2] / 'docs/discovery.md'


def test_every_threshold_says_what_it_is():
    every = list(list_thresholds())
    assert len(every) > 200
    assert len({one.key for one in every}) == len(every)
    assert [one.key for one in every if not one.about] == []


def test_the_values_of_the_page_are_those_that_the_code_uses():
    for one in list_thresholds():
        used = getattr(import_module(f'lta_discovery.{one.module}'), one.name)
        base, angle, _ = one.value.partition(' * math.pi / 180.0')
        base, _, power = base.partition('**')
        value = float(base) ** float(power or 1.0)
        assert used == pytest.approx(math.radians(value) if angle else value), one.key


def test_no_number_that_a_module_declares_is_left_out():
    """Be it written over two lines, or two in one."""
    listed = {one.key for one in list_thresholds()}
    left = set()
    for part in PARTS:
        for module, text in read_sources(part):
            targets = [
                target
                for node in ast.parse(text).body
                if isinstance(node, ast.Assign | ast.AnnAssign)
                # What is computed, or another threshold by its name, is none of its own.
                and not any(
                    isinstance(piece, ast.Call | ast.Name) for piece in ast.walk(node.value)
                )
                for target in getattr(node, 'targets', [getattr(node, 'target', None)])
            ]
            names = [
                name.id
                for target in targets
                for name in ast.walk(target)
                if isinstance(name, ast.Name)
            ]
            found = import_module(f'lta_discovery.{module}')
            numbers = [name for name in names if isinstance(getattr(found, name), int | float)]
            left |= {f'{module}.{name}' for name in numbers if name not in SHAPES} - listed
    assert left == set()


def test_a_file_that_the_page_names_is_there():
    text = PAGE.read_text(encoding='utf-8')
    folder = Path(import_module('lta_discovery').__file__).parent
    named = set(re.findall(r'`([\w/]+\.py)`', text))
    assert 'model/parameters.py' in named
    assert sorted(name for name in named if not (folder / name).exists()) == []


def test_the_page_lists_the_keys_of_the_result():
    text = PAGE.read_text(encoding='utf-8')
    table = text[text.index('`discovery.json`:') : text.index('## The demonstration')]
    listed = re.findall(r'^\| (`[^|]+) \|', table, re.MULTILINE)
    nothing = StudyResult('none', (), (), (), (), False, (), (), 1, {}, 'gtmab')
    assert {key.strip('`') for row in listed for key in row.split(', ')} == set(to_dict(nothing))
