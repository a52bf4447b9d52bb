"""One bridge to a drone, and what is said where there is no way to one."""

import os
from pathlib import Path
import subprocess
import sys

from lta_bridge.crazyflie.claim import Claim
from lta_bridge.crazyflie.remedies import remedied
from lta_config.errors import BadInput
import pytest

URI = 'udp://127.0.0.1:1'


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch):
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))


def test_a_second_bridge_to_a_drone_is_refused_by_name_and_another_drone_is_not():
    first = Claim(URI)
    with pytest.raises(BadInput, match=rf'by another program \(process {os.getpid()}\); end that'):
        Claim(URI)
    Claim('udp://127.0.0.1:2').close()
    first.close()
    first.close()
    Claim(URI).close()


def test_a_claim_ends_with_its_process(tmp_path):
    code = (
        f'import tempfile; tempfile.tempdir = {str(tmp_path)!r}\n'
        'from lta_bridge.crazyflie.claim import Claim\n'
        f'import os; claim = Claim({URI!r}); os._exit(9)'
    )
    paths = os.pathsep.join(sys.path)
    died = subprocess.run([sys.executable, '-c', code], env={**os.environ, 'PYTHONPATH': paths})
    assert died.returncode == 9
    Claim(URI).close()


@pytest.mark.parametrize(
    ('said', 'told'),
    [
        ("Couldn't load link driver: Cannot find a Crazyradio Dongle\n\nTraceback", 'plug one in'),
        ('[Errno 13] Access denied (insufficient permissions)', 'udev rule'),
        ("[Errno 13] could not open port /dev/ttyACM0: Permission denied: 'x'", 'dialout'),
        ("Couldn't load link driver: Could not open usb://0", 'plug it in and switch it on'),
        ("Couldn't load link driver: Could not identify device", 'no such serial port'),
        ("Couldn't load link driver: [Errno 111] Connection refused", 'start what should'),
        ("Couldn't load link driver: [Errno -2] Name or service not known", 'correct the URI'),
        ('Error communicating with the Crazyflie', 'switch the Crazyflie on'),
        ('No backend available', 'apt install libusb-1.0-0'),
        ('\n  odd \n more', 'odd'),
        ('', 'the link failed'),
    ],
)
def test_what_a_library_says_becomes_one_sentence_with_the_remedy(said, told):
    assert told in remedied(said)
    assert '\n' not in remedied(said)
