"""The runner of the benchmarks: ratios, choices, what is skipped, and the file it leaves."""

import json
import os
from pathlib import Path
import subprocess
import sys

from lta_config.errors import BadInput
import pytest

FOLDER = Path(__file__).resolve().parents[2] / 'benchmark'


@pytest.fixture
def bench(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.delitem(sys.modules, 'bench', raising=False)
    import bench

    yield bench
    sys.modules.pop('bench')


def series(*values):
    """Return a measurement that gives these samples."""
    waiting = list(values)
    return lambda: waiting.pop(0)


def pair(bench, choose=max):
    """Return a figure of ours with two peers."""
    return [
        bench.Figure('a.peer', '1/s', series(1.0, 2.0), 2, choose, 'ours.a', 'A 1'),
        bench.Figure('ours.a', '1/s', series(8.0, 6.0), 2, choose),
        bench.Figure('b.peer', '1/s', series(4.0), 1, choose, 'ours.a', 'B 2'),
    ]


def module(bench, monkeypatch, figures):
    """Make `figures` the only benchmark."""
    made = type(sys)('made')
    made.figures = figures
    monkeypatch.setitem(sys.modules, 'made', made)
    monkeypatch.setattr(bench, 'benchmarks', lambda: {'made': 'made'})


def test_the_ratio_is_ours_over_the_peers_and_ours_is_over_the_best(bench):
    (group,) = bench.groups(pair(bench))
    assert [figure.name for figure in group] == ['ours.a', 'a.peer', 'b.peer']
    values, absent = bench.sample(group)
    assert absent == []
    rows = bench.rows_of(values)
    assert [(row.name, row.value, row.peer, row.ratio) for row in rows] == [
        ('ours.a', 8.0, 'B 2', 2.0),
        ('a.peer', 2.0, 'A 1', 4.0),
        ('b.peer', 4.0, 'B 2', 2.0),
    ]


def test_of_times_the_shortest_counts(bench):
    (group,) = bench.groups(pair(bench, min))
    rows = bench.rows_of(bench.sample(group)[0])
    assert [(row.value, row.peer, row.ratio) for row in rows] == [
        (6.0, 'A 1', 6.0),
        (1.0, 'A 1', 6.0),
        (4.0, 'B 2', 1.5),
    ]


def test_a_group_is_sampled_turn_about(bench):
    order = []

    def sampled(name):
        return lambda: float(order.append(name) or 1)

    figures = [
        bench.Figure('ours', '1', sampled('ours'), 2),
        bench.Figure('peer', '1', sampled('peer'), 2, of='ours'),
    ]
    bench.sample(bench.groups(figures)[0])
    assert order == ['ours', 'peer', 'ours', 'peer']


def test_a_peer_without_ours_has_a_value_and_no_ratio(bench):
    (group,) = bench.groups([bench.Figure('peer', '1', series(3.0), 1, of='ours', peer='P')])
    assert bench.rows_of(bench.sample(group)[0]) == [bench.Row('peer', 3.0, '1', 'P', None)]


def test_all_is_written_though_one_breaks(bench, monkeypatch, tmp_path, capsys):
    def broken():
        raise ZeroDivisionError('no wall clock')

    figures = [bench.Figure('good', 's', series(0.5), 1), bench.Figure('bad', 's', broken, 1)]
    module(bench, monkeypatch, lambda: figures)
    monkeypatch.setattr(bench, 'RESULTS', tmp_path / 'runs' / 'bench.json')
    assert bench.main() == 1
    content = json.loads(bench.RESULTS.read_text())
    assert content['rows'] == [
        {'name': 'good', 'value': 0.5, 'unit': 's', 'peer': None, 'ratio': None}
    ]
    assert len(content['load']) == 2
    assert content['cores'] >= 1
    assert [path.name for path in bench.RESULTS.parent.iterdir()] == ['bench.json']
    assert 'bad failed: ZeroDivisionError: no wall clock' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('error', 'said', 'status'),
    [
        (BadInput('There is no GPU; find one.'), 'made skipped: There is no GPU; find one.', 0),
        (
            ModuleNotFoundError("No module named 'rclpy'", name='rclpy'),
            'made skipped: rclpy is not installed; '
            '.venv/bin/pip install -c constraints.txt -r requirements.txt',
            0,
        ),
        (ModuleNotFoundError('', name='lta_sim.gone'), 'made failed: lta_sim.gone is not', 1),
        (TypeError('a bug'), 'made failed: TypeError: a bug', 1),
    ],
)
def test_what_is_lacking_is_skipped_and_a_bug_is_not(
    bench, monkeypatch, tmp_path, capsys, error, said, status
):
    def figures():
        raise error

    module(bench, monkeypatch, figures)
    monkeypatch.setattr(bench, 'RESULTS', tmp_path / 'bench.json')
    assert bench.main() == status
    assert said in capsys.readouterr().out


def test_an_unknown_name_is_refused_before_anything_is_measured(bench, capsys):
    assert bench.main(['kernal']) == 2
    assert "no benchmark 'kernal'; known: " in capsys.readouterr().err


def test_every_file_is_a_benchmark(bench):
    assert {'kernel', 'graph', 'gpu', 'vlc', 'mujoco', 'rotorpy', 'crazyflow'} <= set(
        bench.benchmarks()
    )
    for name in bench.benchmarks().values():
        path = FOLDER / (name.replace('.', '/') + '.py')
        assert '\ndef figures() -> list[Figure]:\n' in path.read_text(), name


def test_each_peer_is_pinned_to_one_version():
    file = FOLDER.parents[1] / 'requirements-bench.txt'
    lines = [line for line in file.read_text().splitlines() if not line.startswith('#')]
    pins = dict(line.split('==') for line in lines)
    of_laws = {'pysindy', 'scikit-learn'}  # imported by law_peers.py
    assert pins.keys() == of_laws | {path.stem for path in FOLDER.glob('peers/[!_]*.py')}


def test_a_sample_that_is_no_number_fails(bench):
    _, absent = bench.sample([bench.Figure('mute', 's', series(float('nan')), 1)])
    assert [(each.why, each.failed) for each in absent] == [
        ('ArithmeticError: a sample is nan', True)
    ]


# One sample of these takes a few seconds; the others fly a graph, compile or search for effects
QUICK = {'loop', 'supply', 'tables', 'vlc'}
# These need a quiet machine: a board sends in real time, and no message may be lost
QUIET = {'light_link', 'record'}


@pytest.mark.parametrize('quick', [True, pytest.param(False, marks=pytest.mark.long)])
def test_every_benchmark_can_be_measured(bench, quick):
    names = QUICK if quick else bench.benchmarks().keys() - QUICK - QUIET
    done = subprocess.run(
        [sys.executable, FOLDER / 'bench.py', '--once', *names],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert 'failed' not in done.stdout
