"""One bridge to a drone, and what is said where there is no way to one."""

import fcntl
import hashlib
import os
from pathlib import Path
import subprocess
import sys

from lta_bridge.crazyflie.drone_lock import DroneLock, normalize_uri
from lta_bridge.crazyflie.remedies import suggest_remedy
from lta_config.errors import BadInput
import pytest

URI = 'udp://127.0.0.1:1'


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch):
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))


def test_a_second_bridge_to_a_drone_is_refused_by_name_and_another_drone_is_not():
    first = DroneLock(URI)
    with pytest.raises(
        BadInput, match=rf'Another program \(process {os.getpid()}\) already commands'
    ):
        DroneLock(URI)
    DroneLock('udp://127.0.0.1:2').close()
    first.close()
    first.close()
    DroneLock(URI).close()


def test_no_file_is_left_and_a_claim_on_a_deleted_one_is_none(tmp_path, monkeypatch):
    former, lock = DroneLock(URI), fcntl.flock
    claims = []

    def release_first(file, operation):
        """Let the former holder end, and a third program come, between opening and locking."""
        monkeypatch.setattr(fcntl, 'flock', lock)
        former.close()
        claims.append(DroneLock(URI))
        lock(file, operation)

    monkeypatch.setattr(fcntl, 'flock', release_first)
    with pytest.raises(BadInput, match='already commands'):
        DroneLock(URI)
    claims[0].close()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ('one', 'other', 'same'),
    [
        ('radio://0/80', 'radio://1/80/2M/e7e7e7e7e7?rate_limit=100', True),  # another dongle
        ('radio://0/80/250K/1', 'radio://0/80/250K/0000000001', True),
        ('radio://0/80/2M/E7E7E7E7E7', 'radio://0/80/2M/E7E7E7E701', False),
        ('radio://0/80', 'radio://0/81', False),
        ('radio://0/80/1M', 'radio://0/80/2M', False),
        ('udp://localhost:19850', 'udp://127.0.0.1:19850', True),
        ('udp://127.0.0.1:19850', 'udp://127.0.0.1:19851', False),
        ('usb://0', 'usb://1', False),
        ('serial:///dev/ttyACM0', 'serial:///dev/ttyACM0', True),
    ],
)
def test_a_drone_has_one_claim_however_it_is_reached(one, other, same):
    assert (normalize_uri(one) == normalize_uri(other)) == same


def test_a_file_that_may_not_be_opened_is_one_sentence_and_a_link_is_not_followed(tmp_path):
    claim = DroneLock(URI)
    (path,) = tmp_path.glob('*.lock')
    claim.close()
    precious = tmp_path / 'precious'
    precious.write_text('all of it')
    path.symlink_to(precious)
    with pytest.raises(
        BadInput, match=r'cannot be opened .*Ask the user who owns the file to stop'
    ):
        DroneLock(URI)
    assert precious.read_text() == 'all of it'


def test_a_claim_ends_with_its_process(tmp_path):
    code = (
        f'import tempfile; tempfile.tempdir = {str(tmp_path)!r}\n'
        'from lta_bridge.crazyflie.drone_lock import DroneLock\n'
        f'import os; lock = DroneLock({URI!r}); os._exit(9)'
    )
    paths = os.pathsep.join(sys.path)
    died = subprocess.run([sys.executable, '-c', code], env={**os.environ, 'PYTHONPATH': paths})
    assert died.returncode == 9
    DroneLock(URI).close()


@pytest.mark.parametrize(
    ('said', 'told'),
    [
        ("Couldn't load link driver: Cannot find a Crazyradio Dongle\n\nTraceback", 'plug one in'),
        ('[Errno 13] Access denied (insufficient permissions)', 'udev rule'),
        ("[Errno 13] could not open port /dev/ttyACM0: Permission denied: 'x'", 'dialout'),
        ("Couldn't load link driver: Could not open usb://0", 'plug it in and switch it on'),
        (
            "Couldn't load link driver: Could not identify device",
            'serial port of the URI does not exist',
        ),
        (
            "Couldn't load link driver: [Errno 111] Connection refused",
            'start the drone or its',
        ),
        ("Couldn't load link driver: [Errno -2] Name or service not known", 'correct the URI'),
        (
            'Error communicating with the Crazyflie',
            'no longer answers: switch it on',
        ),
        ('No backend available', 'apt install libusb-1.0-0'),
        ('\n  odd \n more', 'odd'),
        ('', 'the connection to the Crazyflie failed'),
    ],
)
def test_what_a_library_says_becomes_one_sentence_with_the_remedy(said, told):
    assert told in suggest_remedy(said)
    assert '\n' not in suggest_remedy(said)


def test_every_bridge_looks_for_the_same_file_and_writes_its_number_into_it(tmp_path):
    """The path is part of the contract between bridges of different versions."""
    name = hashlib.sha256(URI.encode()).hexdigest()[:16]
    path = tmp_path / f'lta-crazyflie-{name}.lock'
    path.write_text('123456789012')  # left by a process that died
    claim = DroneLock(URI)
    assert path.read_text() == str(os.getpid())
    claim.close()
