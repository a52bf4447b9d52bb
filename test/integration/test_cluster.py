# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sweep survives a worker and the scheduler of a Dask cluster."""

from contextlib import ExitStack
import io
import json
from pathlib import Path
import subprocess
import sys

from distributed import Client
from ports import free_port
from pyarrow import parquet
import pytest
from waiting import PATIENCE, wait_until
import yaml

COUNT = 30
MERCY = 5  # flights that have to be stored before something is killed


@pytest.fixture
def sweep(tmp_path):
    """Return a sweep file of flights that take a tenth of a second each."""
    content = {
        'schema': 1, 'name': 'short', 'about': 'Short flights.', 'vehicle': 'gtmab',
        'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab',
        'seeds': {'count': COUNT // 2}, 'set': {'scenario.goal.time_limit': '3 s'},
        'vary': {'vehicle.trim.heaviness': ['1 g', '2 g']},
    }  # fmt: skip
    path = tmp_path / 'short.yaml'
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.fixture
def dask():
    """Return a function that starts a program of Dask which only this machine reaches."""
    with ExitStack() as running:

        def start(*words):
            program = Path(sys.executable).parent / 'dask'
            command = [program, *map(str, words), '--host', '127.0.0.1', '--no-dashboard']
            process = running.enter_context(subprocess.Popen(command, stderr=subprocess.DEVNULL))
            running.callback(process.terminate)
            return process

        yield start


def start_worker(dask, address, count):
    """Start a worker; return it when the scheduler has so many."""
    process = dask('worker', address, '--nthreads', 1, '--no-nanny')
    with Client(address, set_as_default=False, timeout=PATIENCE) as client:
        client.wait_for_workers(count, timeout=PATIENCE)
    return process


def count_stored(folder):
    log = folder / 'flights.jsonl'
    return len(log.read_bytes().splitlines()) - 1 if log.exists() else 0


def await_stored(command, folder, count):
    """Wait until so many flights are stored, but not all."""
    wait_until(lambda: count_stored(folder) >= count, f'{count} flights', lambda: command.text)
    assert count_stored(folder) < COUNT, 'there is nothing left to interrupt'


def read_results(folder):
    """Return the bytes of the table, and the log in its order, both without computing times."""
    table = parquet.read_table(folder / 'flights.parquet').drop_columns(['wall'])
    parquet.write_table(table, written := io.BytesIO())
    head, *lines = (folder / 'flights.jsonl').read_text().splitlines()
    rows = sorted((json.loads(line) for line in lines), key=lambda row: row['index'])
    return written.getvalue(), head, [{**row, 'wall': 0.0} for row in rows]


def test_a_sweep_survives_a_worker_and_the_scheduler(lta, sweep, dask, tmp_path):
    port = free_port()
    address = f'tcp://127.0.0.1:{port}'
    scheduler = dask('scheduler', '--port', port)
    start_worker(dask, address, 1)
    second = start_worker(dask, address, 2)
    words = ('sweep', sweep, '--no-page', '--out', tmp_path / 'far', '--scheduler', address)
    flying = lta.start(*words)
    await_stored(flying, tmp_path / 'far', MERCY)
    second.kill()
    await_stored(flying, tmp_path / 'far', count_stored(tmp_path / 'far') + MERCY)
    scheduler.kill()
    assert flying.end() == 2
    assert (
        f"The Dask cluster at '{address}' has lost its scheduler or all of its workers; finished "
        'work is stored: start the cluster again and repeat the command to resume.'
    ) in flying.text.splitlines()
    assert 'Traceback' not in flying.text
    stored = count_stored(tmp_path / 'far')
    assert 2 * MERCY <= stored < COUNT

    scheduler.wait()
    dask('scheduler', '--port', port)
    start_worker(dask, address, 1)
    resumed = lta.start(*words)
    assert resumed.end() == 0, resumed.text
    assert f'{COUNT - stored} flights in' in resumed.text

    local = lta.run('sweep', sweep, '--no-page', '--out', tmp_path / 'here', '--workers', 1)
    assert local.returncode == 0, local.stderr
    assert read_results(tmp_path / 'far') == read_results(tmp_path / 'here')
