"""A sweep survives its workers and itself, and leaves a table with units and a page."""

from collections import Counter
import io
from itertools import islice
import json
from multiprocessing import get_context
import os
from pathlib import Path
import signal
import subprocess
import sys

from lta_config.errors import BadInput
from lta_config.schema.sweep_file import load_sweep
from lta_flight.sweep import run as run_module
from lta_flight.sweep import workers as crew_module
from lta_flight.sweep.cluster import SweepCluster
from lta_flight.sweep.job_runner import build_failed_row, fly_job, SweepRow
from lta_flight.sweep.log import KIND, SweepLog
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_flight.sweep.report import build_report
from lta_flight.sweep.run import sweep_once, SweepRequest
from lta_flight.sweep.statistics import group_by_parameter, wilson_interval
from lta_flight.sweep.workers import LocalWorkers
from lta_report.report import Picture
from pyarrow import parquet
import pytest
from rich.console import Console
from waiting import PATIENCE, wait_until
import yaml

HEAVY = 'vehicle.trim.heaviness'
SHORT = {'scenario.goal.time_limit': '0.2 s'}
QUIET = Console(file=io.StringIO())


class Here:
    """A crew of this process alone: a worker imports a second's worth before it flies."""

    deaths = 0

    def __init__(self, fly, size):
        self._fly = fly

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def run_jobs(self, jobs):
        return map(self._fly, jobs)


@pytest.fixture
def here(monkeypatch):
    """Fly without workers, for tests that are not about them."""
    monkeypatch.setattr(run_module, 'LocalWorkers', Here)


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
    return sweep_once(SweepRequest(file, folder, workers=1, **options), QUIET)


def test_a_sweep_is_flown_kept_and_not_flown_again(sweep, tmp_path):
    file, folder = sweep(), tmp_path / 'out'
    done = run(file, folder)
    assert (done.flown, done.deaths) == (8, 0)
    assert [row.index for row in done.rows] == list(range(8))
    assert Counter(row.outcome for row in done.rows) == {'timeout': 8}
    again = run(file, folder)
    assert again.flown == 0
    assert again.rows == done.rows


@pytest.mark.long
def test_a_row_is_the_flight_itself(sweep, tmp_path):
    """Flown by a worker or by hand, a flight comes to the same figures."""
    file = sweep(1)
    row = run(file, tmp_path / 'out').rows[1]
    plan = SweepPlan(load_sweep(file))
    assert fly_job(plan.base, plan.build_job(1)).figures == row.figures
    assert row.values == {HEAVY: pytest.approx(2e-3, rel=1e-15)}


def test_a_torn_line_is_flown_again(sweep, tmp_path, here):
    file, folder = sweep(), tmp_path / 'out'
    whole = run(file, folder).rows
    log = folder / KIND.file
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b''.join(lines[:5]) + lines[5][:40])
    done = run(file, folder)
    assert done.flown == 4
    assert [row.figures for row in done.rows] == [row.figures for row in whole]


def test_another_sweep_is_not_mixed_in(sweep, tmp_path, here):
    folder = tmp_path / 'out'
    run(sweep(1), folder)
    with pytest.raises(
        BadInput,
        match='is the log of a sweep with other settings; choose another folder with --out',
    ):
        run(sweep(2), folder)
    (tmp_path / 'full').mkdir()
    (tmp_path / 'full' / 'thesis.tex').touch()
    with pytest.raises(BadInput, match='contains files that do not belong to a sweep'):
        run(sweep(1), tmp_path / 'full')


def test_two_sweeps_do_not_write_to_one_log(tmp_path):
    with SweepLog(tmp_path, 'a'), pytest.raises(BadInput, match='Another sweep is writing to'):
        SweepLog(tmp_path, 'a')


def test_a_flight_that_cannot_be_flown_is_kept_with_its_reason(sweep, tmp_path, here):
    """Each of the two values is fine alone: a start near the wall, and a room that ends there."""
    vary = {
        'scenario.start.position': ['[-3.5, 0] m', '[-4.5, 0] m'],
        'scenario.room.size': ['[10, 8, 3] m', '[8, 8, 3] m'],
    }
    file, folder = sweep(1, vary=vary), tmp_path / 'out'
    done = run(file, folder)
    assert [row.outcome for row in done.rows] == ['timeout'] * 3 + ['failed']
    assert 'outside the room' in done.rows[3].sentence
    assert run(file, folder).flown == 0
    assert run(file, folder, retry=True).flown == 1
    report = build_report(done)
    first, *others = report.blocks[-1].rows
    assert (first[0], first[-2]) == ('3', 'failed')
    assert 'outside the room' in first[-1]
    assert [row[-2] for row in others] == ['timeout'] * 3
    assert 'simulate --vehicle gtmab' in report.commands['Fly the first lost flight']
    assert report.headline.startswith('0 of 4 flights reached their goal, and 1 could not be')
    assert report.closing[1].startswith('1 failed: ')
    assert report.status == 1


def lethal(base, job):
    """Fly, but die over flight 2; over flight 1 the first time only."""
    mark = Path(os.environ['LTA_TEST_FOLDER']) / 'died'
    if job.index == 2 or (job.index == 1 and not mark.exists()):
        if job.index == 1:
            mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return SweepRow(job.index, job.seed, {}, 'reached', 'reached its goal')


def lethal_work(connection, base):
    while (job := connection.recv()) is not None:
        connection.send(lethal(base, job))


def test_a_worker_that_dies_costs_no_result(tmp_path, monkeypatch):
    """Its flight goes to another worker; a flight that kills two is given up, and said."""
    monkeypatch.setenv('LTA_TEST_FOLDER', str(tmp_path))
    monkeypatch.setattr(crew_module, 'run_worker', lethal_work)
    monkeypatch.setattr(crew_module, 'get_context', lambda _: get_context('fork'))
    jobs = [SweepJob(k, k, {}) for k in range(6)]
    with LocalWorkers(None, 2) as crew:
        rows = {row.index: row for row in crew.run_jobs(iter(jobs))}
    assert crew.deaths == 3
    assert sorted(rows) == list(range(6))
    assert [rows[k].outcome for k in (0, 1, 3, 4, 5)] == ['reached'] * 5
    assert rows[2].outcome == 'failed'
    assert rows[2].sentence == '2 worker processes ended during this flight, the last by SIGKILL.'


def stillborn(connection, base):
    os._exit(7)


def test_workers_that_never_fly_end_the_sweep(monkeypatch):
    monkeypatch.setattr(crew_module, 'run_worker', stillborn)
    monkeypatch.setattr(crew_module, 'get_context', lambda _: get_context('fork'))
    jobs = (SweepJob(k, k, {}) for k in range(100))
    with LocalWorkers(None, 1) as crew, pytest.raises(BadInput, match='exit status 7'):
        list(crew.run_jobs(jobs))


SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[3:]
from lta_flight.sweep.report import find_status
from lta_flight.sweep.run import sweep_once, SweepRequest
from rich.console import Console
if __name__ == '__main__':
    order = SweepRequest(sys.argv[1], Path(sys.argv[2]), workers=1)
    sys.exit(find_status(sweep_once(order, Console())))
"""


def children(pid):
    return [int(word) for word in Path(f'/proc/{pid}/task/{pid}/children').read_text().split()]


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
        log = folder / KIND.file
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
    assert done.flown in (40 - before, 40 - before + 1)  # a line may have been torn
    assert [row.index for row in done.rows] == list(range(40))


def test_the_table_has_units_and_meanings(sweep, tmp_path, here):
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
    assert table['closest'].to_pylist() == pytest.approx([7.0, 7.0], abs=0.01)
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


def test_the_report_shows_every_parameter(sweep, tmp_path, here):
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

    class Stopping(Here):
        def run_jobs(self, jobs):
            yield from map(self._fly, islice(jobs, 2))
            raise failure

    monkeypatch.setattr(run_module, 'LocalWorkers', Stopping)
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


def test_a_cluster_without_dask_is_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, 'distributed', None)
    with pytest.raises(BadInput, match='-r requirements-dask'):
        SweepCluster(None, 'tcp://127.0.0.1:1')


def test_a_cluster_that_is_not_there_leaves_no_folder(monkeypatch, tmp_path, sweep):
    monkeypatch.setitem(sys.modules, 'distributed', None)
    out = tmp_path / 'out'
    with pytest.raises(BadInput):
        sweep_once(SweepRequest(sweep(2), out, scheduler='tcp://127.0.0.1:1'), Console())
    assert not out.exists()


def test_a_cluster_flies_what_this_machine_flies(sweep):
    """A scheduler with two workers in this process; needs the optional dask.distributed."""
    distributed = pytest.importorskip('distributed')
    plan = SweepPlan(load_sweep(sweep(2)))
    options = {'processes': False, 'n_workers': 2, 'threads_per_worker': 1}
    with (
        distributed.LocalCluster(**options, dashboard_address=None) as cluster,
        SweepCluster(plan.base, cluster.scheduler_address) as crew,
    ):
        rows = sorted(crew.run_jobs(plan.iterate_jobs({1})), key=lambda row: row.index)
    assert [row.index for row in rows] == [0, 2, 3]
    assert [row.figures for row in rows] == [
        fly_job(plan.base, plan.build_job(k)).figures for k in (0, 2, 3)
    ]
