"""What `lta cluster` refuses, before anything listens."""

import socket

from lta_report import cluster_server
import pytest

PARTS = ('--tls-ca', 'a.pem', '--tls-cert', 'b.pem')
FILES = (*PARTS, '--tls-key', 'c.key')


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (('up', '--host', '0.0.0.0'), "A cluster on '0.0.0.0' runs any code"),
        (('up', *PARTS), 'Give all of --tls-ca, --tls-cert and --tls-key'),
        (('up', *FILES), 'a.pem, '),
        (('up', '--host', 'no.such.host.invalid'), "The host 'no.such.host.invalid' is unknown"),
        (('join', 'tcp://10.0.0.1:8786'), 'add --tls-ca, --tls-cert and --tls-key'),
        (('join', 'tls://10.0.0.1:8786'), 'does not match the certificates'),
        (('join', 'tcp://127.0.0.1:8786', *FILES), 'does not match the certificates'),
        (('join', '127.0.0.1:8786'), 'give one such as tcp://127.0.0.1:8786'),
        (('join', 'tcp://127.0.0.1:port'), 'give one such as tcp://127.0.0.1:8786'),
    ],
)
def test_refusals_are_one_sentence(call, words, said):
    status, output = call('cluster', *words)
    assert status == 2
    assert said in output.err
    assert len(output.err.splitlines()) == 1


def test_a_port_in_use_is_one_sentence(call):
    with socket.create_server(('127.0.0.1', 0)) as taken:
        port = taken.getsockname()[1]
        status, output = call('cluster', 'up', '--port', port)
    assert status == 2
    assert output.err.startswith(f'Cannot listen on port {port} of 127.0.0.1 (')
    assert len(output.err.splitlines()) == 1


def test_a_missing_scheduler_is_one_sentence(call, monkeypatch):
    monkeypatch.setattr(cluster_server, 'PATIENCE', 0.2)
    with socket.create_server(('127.0.0.1', 0)) as once:
        address = f'tcp://127.0.0.1:{once.getsockname()[1]}'
    status, output = call('cluster', 'join', address)
    assert status == 2
    assert f"No Dask scheduler answers at '{address}'" in output.err
    assert 'start one there with "lta cluster up"' in output.err
    assert len(output.err.splitlines()) == 1
