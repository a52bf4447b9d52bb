# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The notebooks of examples/ run from top to bottom and are stored with their figures."""

from contextlib import redirect_stdout
import io
import json
from pathlib import Path
import re

import pytest

FOLDER = Path(__file__).resolve().parents[2] / 'examples'
NOTEBOOKS = sorted(FOLDER.glob('*.ipynb'))
LARGEST = 200_000  # bytes of a notebook with its figures


def read_cells(name):
    """Return the sources of a notebook's cells of Python."""
    book = json.loads((FOLDER / f'{name}.ipynb').read_text(encoding='utf-8'))
    return [''.join(cell['source']) for cell in book['cells'] if cell['cell_type'] == 'code']


@pytest.fixture
def run_notebook(tmp_path, monkeypatch):
    """Return a function that runs a notebook in its folder: what it prints and its variables."""
    (tmp_path / 'examples').mkdir()
    monkeypatch.chdir(tmp_path / 'examples')

    def run(name):
        space, said = {'__name__': '__main__'}, io.StringIO()
        with redirect_stdout(said):
            for k, cell in enumerate(read_cells(name)):
                exec(compile(cell, f'{name} cell {k}', 'exec'), space)
        return said.getvalue(), space

    return run


@pytest.mark.parametrize('path', NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_as_run_and_its_links_lead_somewhere(path):
    book = json.loads(path.read_text(encoding='utf-8'))
    assert book['nbformat'] == 4
    assert path.stat().st_size < LARGEST
    cells = [cell for cell in book['cells'] if cell['cell_type'] == 'code']
    assert [cell['execution_count'] for cell in cells] == [*range(1, len(cells) + 1)]
    outputs = [output for cell in cells for output in cell['outputs']]
    assert any('image/png' in output.get('data', {}) for output in outputs)
    # Progress and warnings, on the error stream, are not stored, nor are absolute paths
    assert not [
        each for each in outputs if each['output_type'] == 'error' or 'stderr' in each.values()
    ]
    assert not re.search(r'/(home|tmp|work|root|Users)/', json.dumps(outputs))
    for cell in book['cells']:
        assert cell['id']
        text = ''.join(cell['source'])
        if cell['cell_type'] == 'code':
            compile(text, path.name, 'exec')
        for target in re.findall(r'\]\(([^)#]+)', text):
            assert (FOLDER / target).exists(), target


def test_there_are_four():
    names = {path.stem for path in NOTEBOOKS}
    assert names == {'first_flight', 'log_to_effect', 'sweep', 'your_effect'}


def test_a_first_flight(run_notebook):
    said, space = run_notebook('first_flight')
    assert 0.5 < space['height'].max() < 0.55  # the altitude of the mission is 0.5 m
    assert abs(space['error']).mean() < 0.02  # docs/analysis.md
    assert Path('../runs/notebook-first/bag').exists()
    assert list(Path().iterdir()) == []
    assert re.match(r'highest 0\.5\d m, flown \d\d\.\d s\nerror of the airspeed: \d', said)


def test_your_effect(run_notebook):
    said, space = run_notebook('your_effect')
    # 3 g/m over 0.5 m, and over at most the length of 1.5 m
    assert space['lift'](0.5) == pytest.approx(-0.003 * 9.80665 * 0.5)
    assert space['lift'](3.0) == pytest.approx(-0.003 * 9.80665 * 1.5)
    assert said.count('mN') == 5


@pytest.mark.long  # four flights; `test_a_sweep_in_python` flies two short ones
def test_a_sweep(run_notebook):
    said, space = run_notebook('sweep')
    assert len(space['rows']) == said.count(' J') == 4


def test_a_sweep_in_python():
    import lta_analysis

    values = {'scenario.goal.time_limit': ['1 s', '2 s']}
    rows = lta_analysis.fly_grid(values, seeds=1)
    assert [row['scenario.goal.time_limit'] for row in rows] == ['1 s', '2 s']
    assert [row['success'] for row in rows] == [False, False]


@pytest.mark.long  # half a minute of discovery; test_discover.py finds such an effect
def test_from_a_log_to_an_effect(run_notebook):
    said, space = run_notebook('log_to_effect')
    (effect,) = space['found']['effects']
    assert effect['name'] == 'linear_drag'
    assert effect['parameters']['surge']['value'] == pytest.approx(0.04, rel=0.1)
    assert 'linear_drag.surge = 0.0' in said
    assert Path('../runs/notebook-log/found/report.html').exists()
