# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sweep survives its workers and itself, and leaves a table with units and a page."""

from collections import Counter
from functools import partial
import io
from itertools import islice
import json
import os
from pathlib import Path
import signal
import subprocess
import sys

from lta_config.errors import BadInput
from lta_config.schema.sweep_file import load_sweep
from lta_flight.sweep import run as run_module
from lta_flight.sweep.batch_workers import (
    build_failed_row,
    fly_job,
    store_row,
    SWEEP_STORE,
    SweepRow,
)
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_flight.sweep.report import build_report
from lta_flight.sweep.run import sweep_once, SweepRequest
from lta_flight.sweep.statistics import group_by_parameter, wilson_interval
from lta_report.report import Picture
from lta_report.study_store import StudyStore
from lta_report.workers import DaskWorkers, ItemFailure
from pyarrow import parquet
import pytest
from rich.console import Console
from waiting import PATIENCE, wait_until
import yaml

HEAVY = 'vehicle.trim.heaviness'
SHORT = {'scenario.goal.time_limit': '0.2 s'}
QUIET = Console(file=io.StringIO())


@pytest.fixture
def sweep(tmp_path):
    """Return a function that writes a sweep file of very short flights."""

    def write(count=4, **content):
        given = {
            'schema': 1, 'name': 'short', 'about': 'Short flights.', 'vehicle': 'gtmab',
            'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab',
            'seeds': {'count': count}, 'set': SHORT, 'vary': {HEAVY: ['1 g', '2 g']},
        }  # fmt: skip
        path = tmp_path / 'short.yaml'
        path.write_text(yaml.safe_dump(given | content))
        return str(path)

    return write


def run(file, folder, **options):
    return sweep_once(SweepRequest(file=file, out=folder, **{'workers': 1, **options}), QUIET)


def test_a_sweep_is_flown_kept_and_not_flown_again(sweep, tmp_path):
    file, folder = sweep(), tmp_path / 'out'
    done = run(file, folder)
    assert (done.new_flights, done.lost) == (8, 0)
    assert [row.index for row in done.rows] == list(range(8))
    assert Counter(row.outcome for row in done.rows) == {'timeout': 8}
    again = run(file, folder)
    assert again.new_flights == 0
    assert again.rows == done.rows
    report = build_report(done)
    assert report.scene.count('seed ') > 1
    assert report.track['time'][-1] == pytest.approx(max(row.track[-1][0] for row in done.rows))


@pytest.mark.long
def test_a_row_is_the_flight_itself(sweep, tmp_path):
    """Flown by a worker or by hand, a flight comes to the same figures."""
    file = sweep(1)
    row = run(file, tmp_path / 'out').rows[1]
    plan = SweepPlan(load_sweep(file))
    assert fly_job(plan.base, plan.build_job(1)).figures == row.figures
    assert row.values == {HEAVY: pytest.approx(2e-3, rel=1e-15)}


def test_a_flight_that_cannot_be_flown_is_kept_with_its_reason(sweep, tmp_path):
    """Each of the two values is fine alone: a start near the wall, and a room that ends there."""
    vary = {
        'scenario.start.position': ['[-3.5, 0] m', '[-4.5, 0] m'],
        'scenario.room.size': ['[10, 8, 3] m', '[8, 8, 3] m'],
    }
    file, folder = sweep(1, vary=vary), tmp_path / 'out'
    done = run(file, folder)
    assert [row.outcome for row in done.rows] == ['timeout'] * 3 + ['failed']
    assert 'outside the room' in done.rows[3].sentence
    assert run(file, folder).new_flights == 0
    assert run(file, folder, retry_failed=True).new_flights == 1
    report = build_report(done)
    first, *others = report.blocks[-1].rows
    assert (first[0], first[-2]) == ('3', 'failed')
    assert 'outside the room' in first[-1]
    assert [row[-2] for row in others] == ['timeout'] * 3
    assert 'simulate --vehicle gtmab' in report.commands['Fly the first lost flight']
    assert report.headline.startswith('0 of 4 flights reached their goal, and 1 could not be')
    assert report.closing[1].startswith('1 failed: ')
    assert report.status == 1


def test_a_flight_that_no_worker_finished_is_a_failed_row(tmp_path):
    job = SweepJob(2, 7, {HEAVY: {'value': 2.5, 'unit': 'g'}})
    with StudyStore(tmp_path / 'out', SWEEP_STORE, 'mine') as store:
        assert store_row(store, job, ItemFailure('It died.')) == 'failed'
    with StudyStore(tmp_path / 'out', SWEEP_STORE, 'mine') as store:
        assert store.results == {2: SweepRow(2, 7, {HEAVY: 0.0025}, 'failed', 'It died.')}
    with StudyStore(tmp_path / 'out', SWEEP_STORE, 'mine', retry_failed=True) as store:
        assert 2 not in store


def test_the_lines_of_the_store_are_the_rows(tmp_path):
    row = SweepRow(0, 1, {HEAVY: 1e-3}, 'reached', 'It did.', 0.25, {'end': 1.5, 'power': None})
    with StudyStore(tmp_path, SWEEP_STORE, 'mine') as store:
        store.add(0, row)
    first, line = map(json.loads, (tmp_path / 'flights.jsonl').read_text().splitlines())
    assert first == {'sweep': 'mine'}
    assert line == {
        'index': 0, 'seed': 1, 'values': {HEAVY: 1e-3}, 'outcome': 'reached',
        'sentence': 'It did.', 'wall': 0.25, 'figures': {'end': 1.5, 'power': None},
        'track': [],
    }  # fmt: skip


SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[3:]
from lta_flight.sweep.report import find_status
from lta_flight.sweep.run import sweep_once, SweepRequest
from lta_report.study import StudyOptions
from rich.console import Console
if __name__ == '__main__':
    order = SweepRequest(file=sys.argv[1], out=Path(sys.argv[2]), workers=2)
    sys.exit(find_status(sweep_once(order, Console())))
"""


def children(pid):
    """Return the children of all threads of a process."""
    tasks = Path(f'/proc/{pid}/task').glob('*/children')
    return [int(word) for task in tasks for word in task.read_text().split()]


def heeds_no_interrupt(pid):
    """Tell whether a process blocks or ignores SIGINT: bits 1 of what the kernel says of it."""
    lines = dict(
        line.split(':\t', 1) for line in Path(f'/proc/{pid}/status').read_text().splitlines()
    )
    return bool((int(lines['SigBlk'], 16) | int(lines['SigIgn'], 16)) & 1 << (signal.SIGINT - 1))


@pytest.mark.long
@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGINT])
def test_a_sweep_that_is_stopped_goes_on_where_it_was(sweep, tmp_path, number):
    """Killed, or by Ctrl-C to all its processes; no worker outlives it, no flight is lost."""
    file, folder, script = sweep(20), tmp_path / 'out', tmp_path / 'script.py'
    script.write_text(SCRIPT)
    command = [sys.executable, str(script), file, str(folder), *sys.path]
    said = (tmp_path / 'said').open('w+')
    sweeping = subprocess.Popen(
        command,
        start_new_session=True,
        stderr=said,
        # A shell's background job ignores Ctrl-C, and so does what it starts.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        log = folder / SWEEP_STORE.file
        wait_until(
            lambda: log.exists() and log.read_bytes().count(b'\n') >= 6, 'five flights in the log'
        )
        workers = children(sweeping.pid)
        assert workers
        assert all(map(heeds_no_interrupt, workers))
        if number is signal.SIGINT:
            os.killpg(sweeping.pid, number)
        else:
            sweeping.send_signal(number)
        assert sweeping.wait(PATIENCE) == (130 if number is signal.SIGINT else -number)
    finally:
        sweeping.kill()
        sweeping.wait()
    wait_until(
        lambda: not any(Path(f'/proc/{pid}/cmdline').exists() for pid in workers),
        'the end of the workers',
    )
    with said:
        said.seek(0)
        assert 'Traceback' not in said.read()
    if number is signal.SIGINT:
        assert 5 <= len(parquet.read_table(folder / 'flights.parquet')) < 40
    before = log.read_bytes().count(b'\n') - 1
    done = run(file, folder)
    assert done.new_flights in (40 - before, 40 - before + 1)  # a line may have been torn
    assert [row.index for row in done.rows] == list(range(40))


def test_the_table_has_units_and_meanings(sweep, tmp_path):
    vary = {HEAVY: ['1 g', '2 g'], 'scenario.air.wind': ['[0, 0, 0] m/s'], 'mission.speed': [0.4]}
    done = run(sweep(1, vary=vary), tmp_path / 'out')
    table = parquet.read_table(done.table)
    assert len(table) == 2
    assert table[HEAVY].to_pylist() == pytest.approx([1e-3, 2e-3], rel=1e-15)
    assert table['scenario.air.wind'].to_pylist() == [[0.0, 0.0, 0.0]] * 2
    units = {
        name: table.schema.field(name).metadata[b'unit'].decode() for name in table.schema.names
    }
    assert units[HEAVY] == 'kg'
    assert units['scenario.air.wind'] == units['mission.speed'] == 'm/s'
    assert (units['search_time'], units['heading_error'], units['wall']) == ('s', 'rad', 's')
    assert all(table.schema.field(name).metadata[b'about'] for name in table.schema.names)
    assert table['closest_horizontal'].to_pylist() == pytest.approx([7.0, 7.0], abs=0.01)
    assert table['search_time'].to_pylist() == [None, None]
    about = table.schema.metadata
    assert about[b'identity'].decode() == done.plan.identity
    assert json.loads(about[b'file'])['vary'][HEAVY] == ['1 g', '2 g']


def list_pictures(blocks):
    """Return the pictures among blocks by name."""
    return {
        each.name: each
        for block in blocks
        for each in (getattr(block, 'blocks', None) or [block])
        if isinstance(each, Picture)
    }


def test_the_report_shows_every_parameter(sweep, tmp_path):
    vary = {HEAVY: {'uniform': {'low': '1 g', 'high': '3 g'}}, 'scenario.lamp.flux': ['1 lm']}
    report = build_report(run(sweep(vary=vary, samples=12, seeds={'first': 3}), tmp_path / 'out'))
    pictures = list_pictures(report.blocks)
    assert list(pictures) == [
        'outcomes',
        'spread-search_time',
        'spread-path_length',
        'by-0',
        'by-1',
    ]
    assert report.headline.startswith('0 of 12 flights reached their goal; ')
    assert report.introduction == 'Short flights.'
    # Small masses are drawn in grams
    assert pictures['by-1'].figure.layout.xaxis3.title.text == f'{HEAVY} [g]'


@pytest.mark.parametrize('failure', [KeyboardInterrupt(), BadInput('No scheduler answers.')])
def test_a_stopped_sweep_is_reported_as_far_as_it_came(sweep, tmp_path, monkeypatch, failure):
    """Of four flights, two are flown."""

    def stop(items, workers, save, progress):
        for job in islice(items, 2):
            save(job, SweepRow(job.index, job.seed, {HEAVY: 1e-3}, 'timeout', 'ran out of time'))
        raise failure

    monkeypatch.setattr(run_module, 'run_items', stop)
    report = build_report(run(sweep(2), tmp_path / 'out'))
    assert report.headline.startswith('0 of 2 flights (of 4 planned) reached their goal')
    assert report.status == (130 if isinstance(failure, KeyboardInterrupt) else 2)
    assert 'Finished flights are stored; repeat the command to resume.' in report.closing
    assert ('No scheduler answers.' in report.closing) == isinstance(failure, BadInput)
    assert len(parquet.read_table(tmp_path / 'out/flights.parquet')) == 2


def test_wilson_against_printed_figures():
    """Newcombe 1998, Stat. Med. 17:857, table I, method 3 (Wilson): 81/263, 15/148, 0/20, 1/29."""
    for hits, count, low, high in (
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ):
        share = wilson_interval(hits, count)
        assert (share.low, share.high) == pytest.approx((low, high), abs=5e-5)


def test_drawn_values_are_grouped_evenly():
    rows = [SweepRow(k, 1, {'x': (7 * k) % 100 / 10}, 'reached', '') for k in range(100)]
    found = group_by_parameter(rows, 'x')
    assert [len(group.rows) for group in found] == [13] * 4 + [12] * 4
    places = [group.place for group in found]
    assert places == sorted(places)
    words = group_by_parameter(
        [SweepRow(k, 1, {'x': 'ab'[k % 2]}, 'reached', '') for k in range(4)], 'x'
    )
    assert [(group.name, len(group.rows)) for group in words] == [('a', 2), ('b', 2)]


def test_a_failed_flight_tells_its_values_in_si():
    job = SweepJob(3, 9, {HEAVY: {'value': 2.5, 'unit': 'g'}})
    assert build_failed_row(job, 'No.').values == {HEAVY: 0.0025}


def test_a_cluster_flies_what_this_machine_flies(sweep):
    """A scheduler with two workers in this process; needs the optional dask.distributed."""
    distributed = pytest.importorskip('distributed')
    plan = SweepPlan(load_sweep(sweep(2)))
    options = {'processes': False, 'n_workers': 2, 'threads_per_worker': 1}
    with (
        distributed.LocalCluster(**options, dashboard_address=None) as cluster,
        DaskWorkers(partial(fly_job, plan.base), cluster.scheduler_address) as workers,
    ):
        found = workers.run(plan.iterate_jobs({1}))
        rows = sorted((row for _, row in found), key=lambda row: row.index)
    assert [row.index for row in rows] == [0, 2, 3]
    assert [row.figures for row in rows] == [
        fly_job(plan.base, plan.build_job(k)).figures for k in (0, 2, 3)
    ]
