"""What a row rests on, how rows are taken up again, and what a person sees meanwhile."""

from io import StringIO

from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_studies.reproduce import run
from lta_studies.reproduce.run import reproduce_rows, ReproductionRequest, select_rows
from lta_studies.reproduce.sources import hash_sources, iterate_sources, trace_imports
from lta_studies.reproduce.study_result import RowStudyResult
import pytest
from rich.console import Console

NAMES = ('forces', 'cells')


def named(paths):
    return {f'{path.parent.name}/{path.name}' for path in paths}


def test_a_row_rests_on_its_own_study_on_the_cores_and_on_what_is_configured():
    found = named(iterate_sources('energy'))
    own = {
        'studies/energy.py',
        'paper/energy.yaml',
        'energy/course_flight.py',
    }
    shared = {'vehicles/gtmab.yaml', 'aero/gtmab.sweep.json', 'lta_control/cascade.py'}
    assert own | shared <= found
    assert hash_sources('energy') == hash_sources('energy') != hash_sources('beavis')


def test_a_row_rests_neither_on_other_rows_nor_on_what_it_does_not_import():
    found = named(iterate_sources('cells'))
    assert not {'studies/beavis.py', 'paper/beavis.yaml'} & found
    assert not {'hardware/calibration.py', 'discovery/run.py', 'verbs/reproduce.py'} & found


def test_what_is_imported_is_followed_through_packages_and_functions():
    found = named(trace_imports('lta_studies.reproduce.studies.closed_loop'))
    assert {'reproduce/manoeuvres.py', 'platforms/flight.py', 'lta_flight/closed_loop.py'} <= found


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


def test_a_person_sees_how_many_rows_are_done_and_which(tmp_path, studied):
    text, kepts = shown(tmp_path, terminal=True)
    assert set(kepts) == set(studied) == set(NAMES)
    assert '2/2' in text
    for name in NAMES:
        assert f'{name}: 0 s' in text


def test_nothing_moves_where_nobody_looks(tmp_path, studied):
    assert shown(tmp_path, terminal=False)[0] == ''


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
