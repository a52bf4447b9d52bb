# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The firmware's portable part, compiled here, against the bridge over a pseudo terminal."""

import math
from pathlib import Path
import shutil
import signal
import subprocess
import sys
import time

from light_frames import build_frame
from lta_bridge.teensy.block_assembler import FrameParser
from lta_bridge.teensy.board_clock import ClockExchange
from lta_bridge.teensy.light_board import LightBoard
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import Cable
from lta_model.light.lamp import SquareWave
import numpy as np
import pytest
from square_waves import sample_wave
from waiting import PATIENCE

FIRMWARE = Path(__file__).resolve().parents[2] / 'firmware/light_board'
LIGHT = load_topic_table().light
RATE = LIGHT.sample_rate.si
DRIFT = 80e-6

pytestmark = pytest.mark.skipif(
    not (shutil.which('gcc') and shutil.which('make')), reason='the firmware needs gcc and make'
)


@pytest.fixture(scope='module')
def built(tmp_path_factory):
    """Return the folder of the host's programs."""
    build = tmp_path_factory.mktemp('firmware')
    words = ['make', '-s', '-C', FIRMWARE, f'BUILD={build}', f'PYTHON={sys.executable}', 'CC=gcc']
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return build


def run(built, folder, samples, rate, drift, peak=0.0, held=0.0):
    """Run the board over a cable, held up once; yield all that it sends, and the cable."""
    (folder / 'rows').write_bytes(samples.astype('<u2').tobytes())
    cable = Cable(folder / 'tty')
    words = [folder / 'tty', folder / 'rows', samples.shape[1], rate, drift, peak]
    board = subprocess.Popen(
        [built / 'light_board', *map(str, words)], stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + PATIENCE
    while True:
        if time.monotonic() > deadline:
            board.kill()
            raise AssertionError(f'the board still sends; {board.communicate()[1]}')
        alive = board.poll() is None
        data = cable.read(0.005)
        if data and held:
            board.send_signal(signal.SIGSTOP)
            time.sleep(held)
            board.send_signal(signal.SIGCONT)
            held = 0.0
        yield cable, data
        if not alive and not data:
            break
    told = board.communicate()[1]
    cable.pull()
    assert (board.returncode, told) == (0, f'{len(samples)} rows, 0 overruns\n')


@pytest.mark.parametrize('diodes', [8, 16])
def test_every_sample_comes_through_in_order(built, tmp_path, diodes):
    samples = np.random.default_rng(1).integers(0, 4096, (6000, diodes)).astype(np.uint16)
    link, blocks, unsure = LightBoard(LIGHT, diodes), [], []
    for cable, data in run(built, tmp_path, samples, RATE, DRIFT):
        cable.write(link.compose_due_messages(time.monotonic_ns()))
        for block in link.receive_bytes(data, time.monotonic_ns()):
            blocks.append(block)
            unsure.append(link.clock.uncertainty)
    assert (link.blocks.lost, link.framing.crc_errors, link.framing.unknown) == (0, 0, 0)
    assert link.blocks.rows == 6000 - 6000 % (120 // diodes)
    assert len(blocks) + link.undated == link.blocks.rows // 1000
    assert blocks
    for k, block in enumerate(blocks, start=link.undated):
        assert (block.samples == samples[1000 * k : 1000 * (k + 1)]).all()
    # A tenth of a second apart, as far as the clock knows: answers are late on a busy machine.
    off = np.abs(1e-9 * np.diff([block.stamp_ns for block in blocks]) - 1000 / RATE)
    assert np.median(off / (np.array(unsure[1:]) + unsure[:-1])) < 5.0
    assert link.fault == ''


def test_a_board_that_was_held_up_loses_no_row(built, tmp_path):
    """It stands still for 0.3 s, in which three times as many rows are due as it can keep."""
    samples = np.zeros((6000, 8), np.uint16)
    assert sum(len(data) for _, data in run(built, tmp_path, samples, RATE, 0.0, held=0.3)) > 0


def test_its_answers_tell_its_clock(built, tmp_path):
    """A second of questions: a clock that is 2 % fast is seen through any scheduler."""
    framing, answers = FrameParser(), []
    for cable, data in run(built, tmp_path, np.zeros((10_000, 8), np.uint16), RATE, 0.02):
        now = time.monotonic_ns()
        told = [one for one in framing.parse_frames(data) if one.get_type() == 'TIMESYNC']
        answers += [ClockExchange(one.ts1, one.tc1, now) for one in told]
        cable.write(build_frame('TIMESYNC', system=255, ts1=time.monotonic_ns()))
    quick = sorted(answers, key=lambda answer: answer.round_trip)[: len(answers) // 2]
    assert len(quick) > 10
    first = quick[0]
    ours = [1e-9 * (answer.host_midpoint - first.host_midpoint) for answer in quick]
    board = [1e-9 * (answer.board - first.board) for answer in quick]
    assert np.polyfit(ours, board, 1)[0] == pytest.approx(1.02, abs=5e-3)


def test_peaks_are_those_of_the_wave(built, tmp_path):
    """A square wave of height h has a fundamental of 2 h / pi sin(pi duty); the rest is known."""
    times = (np.arange(3000) * 1e9 / RATE).astype(np.int64)
    wave = sample_wave(SquareWave(150.0), times)
    heights = np.array([0, 10, 40, 160, 640, 1000, 2000, 3000])
    samples = 500 + np.outer(wave, heights)
    framing, peaks = FrameParser(), []
    for _, data in run(built, tmp_path, samples, RATE, 0.0, peak=150.0):
        peaks += [m for m in framing.parse_frames(data) if m.get_type() == 'LTA_LIGHT_PEAKS']
    assert [m.sequence for m in peaks] == [0, 1000, 2000]
    for message in peaks:
        window = samples[message.sequence :][:1000].astype(float)
        turns = 2j * math.pi * 150.0 / RATE * np.arange(1000)
        expected = 2e-3 * np.abs(np.exp(-turns) @ (window - window.mean(axis=0)))
        assert message.amplitude[:8] == pytest.approx(expected, rel=2e-4, abs=2e-3)
        assert message.amplitude[:8] == pytest.approx(2.0 / math.pi * heights, rel=2e-3)
        rest = np.sqrt(window.var(axis=0) - 0.5 * expected**2)
        assert message.noise[:8] == pytest.approx(rest, rel=1e-3, abs=1e-2)
        assert (message.diodes, message.window) == (8, 1000)
        assert not any(message.amplitude[8:])


@pytest.mark.parametrize(('frequency', 'duty'), [(150.0, 0.5), (437.3, 0.25)])
def test_the_lamp_keeps_frequency_and_duty(built, frequency, duty):
    """Its timer is 50 ppm fast and knows it: by true time the wave is the simulator's."""
    ticks, rate, drift = 400_000, 100e3, 50e-6
    words = [built / 'lamp', frequency, duty, rate, drift, ticks]
    out = subprocess.run([str(word) for word in words], capture_output=True, check=True).stdout
    found = np.frombuffer(out, np.uint8)
    begins = np.flatnonzero(np.diff(found.astype(int)) == 1)
    cycles = (len(begins) - 1) / (begins[-1] - begins[0]) * rate * (1.0 + drift)
    assert cycles == pytest.approx(frequency, rel=1e-5)
    assert found.mean() == pytest.approx(duty, abs=1e-4)
    # Midway between ticks, where rounding cannot decide.
    moments = ((np.arange(ticks) + 0.5) / (rate * (1.0 + drift)) * 1e9).astype(np.int64)
    expected = sample_wave(SquareWave(frequency, duty), moments)
    edges = 2 * frequency * ticks / rate
    assert np.count_nonzero(expected != found) <= edges


def test_a_lamp_that_does_not_know_its_drift_is_off_by_it(built):
    words = [built / 'lamp', 1000.0, 0.5, 100e3 * (1.0 - 1e-3), 0.0, 200_000]
    out = subprocess.run([str(word) for word in words], capture_output=True, check=True).stdout
    begins = np.flatnonzero(np.diff(np.frombuffer(out, np.uint8).astype(int)) == 1)
    cycles = (len(begins) - 1) / (begins[-1] - begins[0]) * 100e3
    assert cycles == pytest.approx(1001.0, rel=1e-5)
