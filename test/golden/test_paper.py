# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The quick page of the reproduction, found again: every figure within its declared rounding.

Rows whose flights and kernels take longer are found again by `make test-long`.

`./lta reproduce --quick && cp runs/paper-quick/paper.json test/golden/paper_quick.json` makes the
reference anew, after a change that is meant to change what comes out. The full run takes about
an hour of two cores and is not repeated here: docs/paper.md is made of its figures,
paper_full.json.
"""

import json
import math
from pathlib import Path

from kept_figures import kepts_in
from lta_report.report_page import render_report
from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_studies.reproduce.report import build_report
from lta_studies.reproduce.run import reproduce_rows, ReproductionRequest, select_rows
from lta_studies.reproduce.verdict import judge_claims
import pytest
from rich.console import Console
from tools.paper_pages import build_pages, IMAGES

HERE = Path(__file__).parent
TOLD = json.loads((HERE / 'paper_quick.json').read_text(encoding='utf-8'))
ROWS = select_rows([])
LONG = (  # seconds of flights each, and of compiling what flies
    'forces',
    'closed_loop',
    'beavis',
    'mounting',
    'photodiodes',
    'indoors',
    'outdoors',
    'energy',
)
QUICK = [row for row in ROWS if row.name not in LONG]


@pytest.fixture(scope='module')
def studied(tmp_path_factory):
    """Return a function that studies rows, each once."""
    folder, kept = tmp_path_factory.mktemp('paper'), {}

    def studied(rows):
        todo = [row for row in rows if row.name not in kept]
        kept.update(
            reproduce_rows(
                ReproductionRequest(quick=True),
                todo,
                StudyRun(Console(quiet=True), folder, options=StudyOptions(workers=1)),
            )
        )
        return {row.name: kept[row.name] for row in rows}

    return studied


def test_rows_that_are_long_are_rows():
    assert set(LONG) < {row.name for row in ROWS}


@pytest.mark.parametrize(
    'row',
    [pytest.param(row, marks=pytest.mark.long if row.name in LONG else ()) for row in ROWS],
    ids=lambda row: row.name,
)
def test_every_figure_is_found_again_within_its_rounding(row, studied):
    told = TOLD['rows'][row.name]
    kept = studied([row])[row.name]
    found = kept.values
    assert found.keys() == told['values'].keys()
    for name, (value, *_, seeds) in told['values'].items():
        now, measure = found[name], row.measures[name]
        assert now.seeds == seeds, name
        if value is None or isinstance(value, str):
            assert (None if now.value != now.value else now.value) == value, name
        else:
            assert math.isclose(now.value, value, abs_tol=measure.rounding, rel_tol=1e-9), name
    assert {k: str(v) for k, v in judge_claims(row, kept).items()} == told['verdicts']


@pytest.mark.parametrize('rows', [QUICK, pytest.param(ROWS, marks=pytest.mark.long)])
def test_the_page_tells_what_was_found(rows, studied):
    kepts = studied(rows)
    report = build_report(rows, kepts)
    text = render_report(report)
    assert report.headline.replace("'", '&#x27;') in text
    for row in rows:
        assert f'<h2>{row.number}. {row.title}</h2>' in text
        for picture in kepts[row.name].pictures:
            assert f'figure-{row.name}-{picture.name}' in text
            assert picture.command


def test_the_pages_are_made_of_the_full_run_and_of_the_rows_as_they_are():
    told = json.loads((HERE / 'paper_full.json').read_text(encoding='utf-8'))
    kepts = kepts_in(told)
    docs = HERE.parents[1] / 'docs'
    rows = [row for row in ROWS if row.name in kepts]
    for name, text in build_pages(rows, kepts).items():
        assert (docs / name).read_text(encoding='utf-8') == text
    for row in rows:
        first = kepts[row.name].pictures[0]
        assert (docs / IMAGES / f'{row.name}-{first.name}.png').exists()
        assert all(each.command.startswith('./lta ') for each in kepts[row.name].pictures)
        found = {name: str(each) for name, each in judge_claims(row, kepts[row.name]).items()}
        assert found == told['rows'][row.name]['verdicts']


def test_the_pages_are_short():
    docs = HERE.parents[1] / 'docs'
    assert (docs / 'paper.md').stat().st_size <= 4096
    # 25 kB
    assert (docs / 'paper_rows.md').stat().st_size <= 25 * 1024
    assert sum(bool(claim.headline) for row in ROWS for claim in row.claims.values()) == 15
