# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One bridge to a drone, and what is said where there is no way to one."""

import os
import subprocess
import sys

from lta_bridge.crazyflie.connection_manager import suggest_remedy
from lta_bridge.crazyflie.drone_lock import DroneLock, normalize_uri
from lta_config.errors import BadInput
import pytest

URI = f'udp://127.0.0.1:{os.getpid() % 65536}'  # two runs of the tests do not meet


def test_a_second_bridge_to_a_drone_is_refused_by_name_and_another_drone_is_not():
    first = DroneLock(URI)
    with pytest.raises(
        BadInput, match=rf'Another program \(process {os.getpid()}\) already commands'
    ):
        DroneLock(URI)
    DroneLock('udp://127.0.0.2:1').close()
    first.close()
    first.close()
    DroneLock(URI).close()


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


def test_a_killed_process_leaves_nothing(tmp_path):
    """Not by its own exit, in which it could clean up."""
    code = (
        'from lta_bridge.crazyflie.drone_lock import DroneLock\n'
        f'lock = DroneLock({URI!r}); print("locked", flush=True); input()'
    )
    paths = os.pathsep.join(sys.path)
    variables = {**os.environ, 'PYTHONPATH': paths, 'TMPDIR': str(tmp_path)}
    with subprocess.Popen(
        [sys.executable, '-c', code],
        env=variables,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as holder:
        assert holder.stdout.readline() == b'locked\n'
        with pytest.raises(BadInput, match=rf'\(process {holder.pid}\) already commands'):
            DroneLock(URI)
        holder.kill()
    DroneLock(URI).close()
    assert list(tmp_path.iterdir()) == []


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
