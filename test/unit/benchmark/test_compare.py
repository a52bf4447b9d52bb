"""What is worse than the kept ratios is told, rates and costs alike."""

import json
from pathlib import Path
import sys

import pytest

FOLDER = Path(__file__).resolve().parents[2] / 'benchmark'


@pytest.fixture
def compare(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(FOLDER))
    import compare
    import speed_table

    monkeypatch.setattr(compare, 'RESULTS', tmp_path / 'bench.json')
    monkeypatch.setattr(compare, 'REFERENCE', tmp_path / 'reference.json')
    monkeypatch.setattr(compare, 'PAGE', tmp_path / 'validation.md')
    compare.PAGE.write_text(f'Above\n{speed_table.BEGIN}\n{speed_table.END}\nBelow\n')
    yield compare
    for name in ('compare', 'bench', 'speed_table'):
        sys.modules.pop(name, None)


def measured(compare, rate, cost, more=()):
    """Write what `make bench` would."""
    rows = [
        {'name': 'kernel.single', 'value': 1.0, 'unit': 'steps/s', 'peer': 'A', 'ratio': rate},
        {'name': 'reading.list', 'value': 1.0, 'unit': 's', 'peer': 'B', 'ratio': cost},
        {'name': 'loop.realtime', 'value': 9.0, 'unit': 's/s', 'peer': None, 'ratio': None},
        *more,
    ]
    run = {'date': '2026-11-27', 'cores': 2, 'load': [3.2, 1.9], 'rows': rows}
    compare.RESULTS.write_text(json.dumps(run))


@pytest.mark.parametrize(
    ('rate', 'cost', 'worse'),
    [
        (2.0, 0.5, []),
        (4.0, 0.25, []),  # better in both
        (1.7, 0.59, []),  # 18 % worse
        (1.6, 0.5, ['kernel.single is worse beside A by more than 20%.']),
        (2.0, 0.62, ['reading.list is worse beside B by more than 20%.']),
    ],
)
def test_a_fifth_is_the_limit_for_rates_and_costs(compare, capsys, rate, cost, worse):
    measured(compare, 2.0, 0.5)
    assert compare.main(['--keep']) == 0
    measured(compare, rate, cost)
    assert compare.main([]) == bool(worse)
    assert capsys.readouterr().err.splitlines() == worse


def test_what_was_not_measured_is_kept_and_is_no_fault(compare, capsys):
    measured(
        compare, 2.0, 0.5, [{'name': 'x', 'value': 2.0, 'unit': 's', 'peer': 'C', 'ratio': 1.0}]
    )
    compare.main(['--keep'])
    measured(compare, 2.5, 0.5)
    assert compare.main([]) == 0
    assert 'Only in one of the two: x.' in capsys.readouterr().out
    compare.main(['--keep'])
    rows = json.loads(compare.REFERENCE.read_text())['rows']
    assert {row['name']: row['ratio'] for row in rows} == {
        'kernel.single': 2.5,
        'loop.realtime': None,
        'reading.list': 0.5,
        'x': 1.0,
    }


def test_the_page_has_the_stored_figures_and_when_they_were_measured(compare):
    measured(compare, 2.0, 0.5)
    compare.main(['--keep'])
    lines = compare.PAGE.read_text().splitlines()
    assert (lines[0], lines[-1]) == ('Above', 'Below')
    (kernel,) = [line for line in lines if line.startswith('| `kernel.single`')]
    assert '| 1 steps/s | 2 (A) |' in kernel
    assert kernel.endswith('| 2026-11-27, 2 cores, load 2 to 3 |')
    # A figure without a peer has no ratio
    assert any('| `loop.realtime` | 9 s/s |  |' in line for line in lines)


def test_the_shipped_page_is_that_of_the_stored_figures(compare):
    import speed_table

    reference = FOLDER / 'reference.json'
    shipped = speed_table.PAGE.read_text(encoding='utf-8')
    table = speed_table.format_table(reference)
    assert f'{speed_table.BEGIN}\n{table}{speed_table.END}' in shipped
    stored = {row['name'] for row in json.loads(reference.read_text())['rows']}
    assert {'kernel.single', 'kernel.batched', 'loop.realtime', 'graph.realtime'} <= stored


def test_without_a_run_or_a_reference_the_next_step_is_said(compare, capsys):
    assert compare.main([]) == 2
    assert 'run "make bench" first' in capsys.readouterr().err
    measured(compare, 1.0, 1.0)
    assert compare.main([]) == 2
    assert 'ARGS=--keep' in capsys.readouterr().err
