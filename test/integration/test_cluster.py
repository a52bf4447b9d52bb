"""A Dask cluster of our commands: it survives a worker, and a sweep survives its scheduler."""

import io
import json
import re
import shutil
import signal
import subprocess

from distributed import Client
import psutil
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


def start_cluster(lta, *options):
    """Start a cluster; return its process and the address that it prints."""
    cluster = lta.start('cluster', 'up', '--workers', 1, '--port', 0, *options)
    cluster.said('Add workers')
    return cluster, re.search(r'at (t\w+://[\d.:]+);', cluster.text)[1]


def find_worker(command):
    """Return the worker process of a command."""
    (worker,) = (each for each in psutil.Process(command.popen.pid).children(recursive=True)
                 if 'spawn_main' in ' '.join(each.cmdline()))  # fmt: skip
    return worker


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


def test_a_sweep_survives_a_worker_and_the_scheduler(lta, sweep, tmp_path):
    first, address = start_cluster(lta)
    second = lta.start('cluster', 'join', address, '--workers', 1)
    second.said('Joined')
    for command in (first, second):
        for process in (psutil.Process(command.popen.pid), find_worker(command)):
            listening = [each.laddr.ip for each in process.net_connections('tcp')
                         if each.status == psutil.CONN_LISTEN]  # fmt: skip
            assert listening, 'scheduler, workers and their guards listen'
            assert set(listening) == {'127.0.0.1'}, 'and nobody else can connect'

    words = ('sweep', sweep, '--no-page', '--out', tmp_path / 'far', '--scheduler')
    flying = lta.start(*words, address)
    await_stored(flying, tmp_path / 'far', MERCY)
    find_worker(second).kill()
    await_stored(flying, tmp_path / 'far', count_stored(tmp_path / 'far') + MERCY)
    first.popen.kill()
    assert flying.end() == 2
    assert (
        f"The Dask cluster at '{address}' has lost its scheduler or all of its workers; finished "
        'work is stored: start the cluster again and repeat the command to resume.'
    ) in flying.text.splitlines()
    assert 'Traceback' not in flying.text
    stored = count_stored(tmp_path / 'far')
    assert 2 * MERCY <= stored < COUNT

    third, again = start_cluster(lta, '--port', address.rpartition(':')[2])
    # The worker whose scheduler was lost finds the new one at the same address
    with Client(again, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
    resumed = lta.start(*words, again)
    assert resumed.end() == 0, resumed.text
    assert f'{COUNT - stored} flights in' in resumed.text

    local = lta.run('sweep', sweep, '--no-page', '--out', tmp_path / 'here', '--workers', 1)
    assert local.returncode == 0, local.stderr
    assert read_results(tmp_path / 'far') == read_results(tmp_path / 'here')

    second.interrupt()
    assert second.end() == 130
    third.popen.send_signal(signal.SIGTERM)
    assert third.end() == 143
    assert second.text.splitlines()[-1] == third.text.splitlines()[-1] == 'Stopped.'
    assert lta.left() == []


@pytest.mark.long
@pytest.mark.skipif(shutil.which('openssl') is None, reason='openssl makes the certificate')
def test_a_sweep_on_an_encrypted_cluster(lta, sweep, tmp_path):
    key, certificate = tmp_path / 'lta.key', tmp_path / 'lta.pem'
    making = ('openssl', 'req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256',
              '-nodes', '-subj', '/CN=lta', '-keyout', key, '-out', certificate)  # fmt: skip
    subprocess.run(making, check=True, capture_output=True)
    files = ('--tls-ca', certificate, '--tls-cert', certificate, '--tls-key', key)
    cluster, address = start_cluster(lta, *files)
    assert address.startswith('tls://')
    joined = lta.start('cluster', 'join', address, '--workers', 1, *files)
    joined.said('Joined')
    words = ('sweep', sweep, '--no-page', '--out', tmp_path / 'far', '--scheduler', address)
    refused = lta.run(*words)
    assert refused.returncode == 2
    assert 'needs certificates; set DASK_DISTRIBUTED__COMM__TLS__CA_FILE' in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    (printed,) = (line for line in cluster.text.splitlines() if line.startswith('Fly a sweep:'))
    settings = re.findall(r'(DASK_\w+)=(\S+)', printed)
    with pytest.MonkeyPatch.context() as patched:
        for name, value in settings:
            patched.setenv(name, value)
        flown = lta.run(*words)
    assert flown.returncode == 0, flown.stderr
    assert count_stored(tmp_path / 'far') == COUNT
    assert settings[0] == ('DASK_DISTRIBUTED__COMM__TLS__CA_FILE', str(certificate))
    for command in (joined, cluster):
        command.interrupt()
        assert command.end() == 130
