# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a row rests on, how rows are taken up again, and what a person sees meanwhile."""

from io import StringIO

from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_studies.reproduce import run
from lta_studies.reproduce.run import reproduce_rows, ReproductionRequest, select_rows
from lta_studies.reproduce.study_result import RowStudyResult
import pytest
from rich.console import Console

NAMES = ('forces', 'cells')


def test_a_row_is_studied_again_if_its_own_file_or_any_code_changes(monkeypatch):
    row, other = select_rows(NAMES)
    key = run.compute_row_key(row, True)
    assert key == run.compute_row_key(row, True) != run.compute_row_key(row, False)
    assert run.compute_row_key(other, True).split()[1] != key.split()[1]
    assert run.compute_row_key(row.model_copy(update={'title': 'Another'}), True) != key
    monkeypatch.setattr(run, 'hash_sources', lambda: 'other code')
    assert run.compute_row_key(row, True) != key


@pytest.fixture
def studied(monkeypatch):
    """Let every study be done at once, and tell which were."""
    done = []

    def instead(name):
        def study(asked):
            done.append(name)
            return RowStudyResult({}, [])

        return study

    for name in NAMES:
        monkeypatch.setitem(run.STUDIES, name, instead(name))
    return done


def shown(folder, terminal):
    """Return what a console was told while the rows were gathered, and the rows."""
    console = Console(file=StringIO(), force_terminal=terminal, width=100, _environ={})
    kepts = reproduce_rows(
        ReproductionRequest(quick=True),
        select_rows(NAMES),
        StudyRun(console, folder, options=StudyOptions(workers=1)),
    )
    return console.file.getvalue(), kepts


def test_rows_that_are_kept_are_not_studied_again_and_count_as_done(tmp_path, studied):
    shown(tmp_path, terminal=False)
    studied.clear()
    text, kepts = shown(tmp_path, terminal=True)
    assert studied == []
    assert set(kepts) == set(NAMES)
    assert '2/2' in text


def test_what_was_studied_before_a_fault_is_kept_and_the_rest_goes_on(
    tmp_path, studied, monkeypatch
):
    good = run.STUDIES['cells']

    def fails(asked):
        raise KeyboardInterrupt

    monkeypatch.setitem(run.STUDIES, 'cells', fails)
    with pytest.raises(KeyboardInterrupt):
        shown(tmp_path, terminal=False)
    assert studied == ['forces']
    monkeypatch.setitem(run.STUDIES, 'cells', good)
    assert set(shown(tmp_path, terminal=False)[1]) == set(NAMES)
    assert studied == ['forces', 'cells']
