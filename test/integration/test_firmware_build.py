# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`make firmware`: both images, where compilers and the user's checkouts are there."""

from importlib import import_module
import os
from pathlib import Path
import shutil
import socket
import subprocess
import sys

from lta_config.errors import BadInput
import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ('FIRMWARE', 'CORES', 'ADC')
COMPILERS = ('arm-none-eabi-gcc', 'arm-none-eabi-g++')


def built(*words, **environment):
    command = [sys.executable, str(ROOT / 'tools/firmware.py'), *words]
    given = {name: value for name, value in os.environ.items() if name not in SOURCES}
    return subprocess.run(command, env=given | environment, capture_output=True, text=True)


def test_without_a_compiler_it_says_what_to_install(tmp_path):
    done = built(PATH=str(tmp_path))
    assert done.returncode == 2
    assert 'is not installed; run "sudo apt install' in done.stderr
    assert 'gcc-arm-none-eabi' in done.stderr
    assert done.stderr.count('\n') == 1


@pytest.mark.skipif(not all(map(shutil.which, COMPILERS)), reason='needs gcc-arm-none-eabi')
def test_sources_of_another_version_are_refused(tmp_path):
    done = built()
    assert (done.returncode, done.stderr.count('\n')) == (2, 1)
    assert 'git clone --recursive -b 2026.08' in done.stderr
    done = built(FIRMWARE=str(tmp_path))
    assert done.returncode == 2
    assert 'is no complete checkout of bitcraze/crazyflie-firmware' in done.stderr
    (tmp_path / 'vendor/CMSIS/CMSIS/Core/Include').mkdir(parents=True)
    (tmp_path / 'vendor/CMSIS/CMSIS/Core/Include/core_cm4.h').touch()
    done = built(FIRMWARE=str(tmp_path))
    assert done.returncode == 2
    assert 'but LTA was tried with bitcraze/crazyflie-firmware 2026.08' in done.stderr


@pytest.fixture
def firmware(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / 'tools'))
    return import_module('firmware')


def test_a_rehearsal_refuses_the_port_of_an_earlier_one(firmware):
    """Its firmware would answer in place of the one that was just built."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as old:
        old.bind(('0.0.0.0', 0))
        port = old.getsockname()[1]
        with pytest.raises(BadInput) as caught:
            firmware.require_free_ports((port,))
        assert f'has the UDP port {port}, probably the firmware of an earlier' in str(caught.value)
    firmware.require_free_ports((port,))


@pytest.mark.long
@pytest.mark.skipif(
    not all(map(shutil.which, COMPILERS)) or not all(map(os.environ.get, SOURCES)),
    reason='needs gcc-arm-none-eabi, and FIRMWARE, CORES and ADC in the environment',
)
def test_both_images_hold_version_and_vehicle():
    done = built(**{name: os.environ[name] for name in SOURCES})
    assert done.returncode == 0, done.stderr
    crazyflie, board = done.stdout.splitlines()
    assert 'cf2.bin: ltaAppStep, commit' in crazyflie
    assert 'light_board.hex: commit' in board
