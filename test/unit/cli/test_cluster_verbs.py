"""What `lta cluster` refuses, before anything listens."""

import socket

from lta_report import cluster_server

PARTS = ('--tls-ca', 'a.pem', '--tls-cert', 'b.pem')
FILES = (*PARTS, '--tls-key', 'c.key')


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
