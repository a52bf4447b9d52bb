# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The light board's C core on an emulated Cortex-M7 against the bridge, where QEMU is installed.

`apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm`. The emulated processor
counts its time by instructions, and a busy machine hears it late. So our clock here is that of the
stream: it stands at the newest row that was heard, and the bridge must find the board's beside it.
"""

from importlib import import_module
from pathlib import Path
import shutil
import subprocess
import sys
import time

from lta_bridge.teensy.block_assembler import FrameParser
from lta_bridge.teensy.light_board import LightBoard
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import Cable
import numpy as np
import pytest
import serial
from waiting import PATIENCE

FIRMWARE = Path(__file__).resolve().parents[2] / 'firmware/light_board'
NEEDED = ('arm-none-eabi-gcc', 'qemu-system-arm', 'make')
LIGHT = load_topic_table().light
DIODES = 8
ROW = 100_000  # ns
FRAME = 15 * ROW  # ns: what the board knows and we have not heard yet
BOOT = 10**18  # ns: where our clock is when the board's is 0
ENOUGH = 5  # blocks

pytestmark = pytest.mark.skipif(
    not all(map(shutil.which, NEEDED)), reason=f'an emulated Cortex-M7 needs {", ".join(NEEDED)}'
)


@pytest.fixture(scope='module')
def built(tmp_path_factory):
    """Return the folder of the programs for the board."""
    build = tmp_path_factory.mktemp('firmware')
    words = [
        'make',
        '-s',
        '-C',
        FIRMWARE,
        'emulated',
        f'BUILD={build}',
        f'PYTHON={sys.executable}',
    ]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return build


@pytest.fixture
def switched_on(tmp_path):
    """Return a function that runs a program and yields its cable and what has come over it."""
    boards = []

    def run(program):
        cable = Cable(tmp_path / 'tty')
        serial = str((tmp_path / 'tty').readlink())  # QEMU takes what is below /dev alone
        words = ('-M', 'mps2-an500', '-icount', 'shift=1', '-display', 'none', '-monitor', 'none')
        boards.append(
            subprocess.Popen(['qemu-system-arm', *words, '-serial', serial, '-kernel', program])
        )
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            assert boards[-1].poll() is None
            yield cable, cable.read(0.02)
        raise AssertionError(f'the board has not sent enough within {PATIENCE:.0f} s')

    yield run
    for board in boards:
        board.kill()
        board.wait()


def pattern(first):
    """Return what the board's file says of a block's rows, from the number of the first."""
    rows = (first + np.arange(LIGHT.samples, dtype=np.uint32))[:, None]
    told = (DIODES * rows + np.arange(DIODES, dtype=np.uint32)) * np.uint32(2654435761) >> 20
    told[:, :2] = np.hstack([rows, rows >> 12])
    return told & 0xFFF


def test_its_samples_come_through_the_bridge_whole_and_in_our_time(built, switched_on):
    link, framing, blocks, now = LightBoard(LIGHT, DIODES), FrameParser(), [], BOOT
    for cable, data in switched_on(built / 'samples.elf'):
        cable.write(link.compose_due_messages(now))
        for message in framing.parse_frames(data):
            if message.get_type() == 'LTA_LIGHT_BLOCK':
                assert message.time_usec * 1000 == ROW * (message.sequence + 1)
                now = BOOT + ROW * (message.sequence + message.rows)
            elif message.get_type() == 'LTA_LIGHT_STATUS':
                # none lost but by the board, which tells it
                assert link.blocks.lost <= message.overruns
        blocks += link.receive_bytes(data, now + 2 * FRAME)
        if len(blocks) >= ENOUGH:
            break
    assert (link.fault, link.framing.crc_errors, link.framing.unknown) == ('', 0, 0)
    for block in blocks:
        low, high = map(int, block.samples[0, :2])
        first = low + (high << 12)
        assert (block.samples == pattern(first)).all()
        # No exchange of messages can tell better than by half of its round trip.
        known = link.clock.round_trip / 2 + 2 * FRAME
        assert block.stamp_ns == pytest.approx(BOOT + ROW * (first + 1), abs=known)


def test_its_peaks_are_those_of_its_lamp(built, switched_on):
    """A square wave of height h has a fundamental of 2 h / pi; 15 cycles fill the window."""
    framing, peaks = FrameParser(), []
    for _, data in switched_on(built / 'peaks.elf'):
        peaks += [m for m in framing.parse_frames(data) if m.get_type() == 'LTA_LIGHT_PEAKS']
        if len(peaks) >= ENOUGH:
            break
    heights = 100.0 * np.arange(DIODES)
    for message in peaks:
        assert (message.diodes, message.window, message.frequency) == (DIODES, 1000, 150.0)
        assert message.amplitude[:DIODES] == pytest.approx(
            2.0 / np.pi * heights, rel=2e-3, abs=0.01
        )
        rest = heights * np.sqrt(0.25 - 2.0 / np.pi**2)  # half the height squared, less the sine's
        assert message.noise[:DIODES] == pytest.approx(rest, rel=2e-3, abs=0.1)


def test_what_a_world_shows_comes_through_the_bridge_whole(built, tmp_path):
    """The rows are in memory that a program of the host shares, as in campaigns/end_to_end.py."""
    light_core = import_module('campaigns.end_to_end').EmulatedCore
    link, blocks, shown = LightBoard(LIGHT, DIODES), [], 0
    with (
        light_core(built / 'flight.elf', tmp_path) as board,
        serial.Serial(str(board.port), timeout=0.02) as port,
    ):
        deadline = time.monotonic() + PATIENCE
        while len(blocks) < ENOUGH and time.monotonic() < deadline:
            port.write(link.compose_due_messages(time.time_ns()))
            board.sample_light(0.0, pattern(shown).astype(np.uint16))
            shown += LIGHT.samples
            until = time.monotonic() + LIGHT.samples * ROW * 1e-9
            while time.monotonic() < until:
                blocks += link.receive_bytes(port.read(4096), time.time_ns())
    assert (link.fault, link.framing.crc_errors) == ('', 0)
    assert len(blocks) >= ENOUGH
    for block in blocks:
        low, high = map(int, block.samples[0, :2])
        assert (block.samples == pattern(low + (high << 12))).all()
