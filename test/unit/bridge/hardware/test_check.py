# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta hardware check: what hangs here by hand, and both emulators through the verb."""

from contextlib import suppress
from itertools import count
import json
import threading
import time
from types import SimpleNamespace

from bench_body import BenchBody
from frame_faults import FrameFaults
from lta_bridge import devices as found
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import LogBlock
from lta_bridge.devices import find_devices, format_udev_rules, RADIO
from lta_bridge.hardware import board as listening_to_boards
from lta_bridge.hardware import drone as listening_to_drones
from lta_bridge.hardware.check import require_hardware
from lta_bridge.hardware.drone import compute_stream_statistics
from lta_config.errors import BadInput
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.parameters import ARMING
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.teensy.emulated_board import Cable, EmulatedBoard
import numpy as np
import pytest
from waiting import PATIENCE

# cflib logs to files and sockets that its daemon threads close when they please.
pytestmark = [
    pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning'),
    pytest.mark.usefixtures('prompt_cflib'),
]

BEACON = 150.0  # Hz
TALK = 0.005  # s between two of the board's words
ROWS = 200  # of each
EVENTS = 200  # that make a second of listening to a drone


@pytest.fixture(autouse=True)
def counted(monkeypatch):
    """Let listening to a drone take a number of events, however long they take to come."""
    turns = count()
    clock = SimpleNamespace(monotonic=lambda: next(turns) / EVENTS)
    monkeypatch.setattr(listening_to_drones, 'time', clock)
    monkeypatch.setattr('lta_bridge.hardware.check.CONNECT_TIME', PATIENCE)


@pytest.fixture
def talking(monkeypatch, tmp_path):
    """Return a function that makes a board, whose rows are the time for which it is heard."""

    def made(**options):
        board = Talking(tmp_path, **options)
        clock = SimpleNamespace(
            monotonic=lambda: board.sent / 1e4, sleep=time.sleep, time_ns=time.time_ns
        )
        monkeypatch.setattr(listening_to_boards, 'time', clock)
        return board

    return made


@pytest.fixture
def usb(tmp_path):
    """A machine with a Crazyradio that may be opened, one that may not, and a mouse."""
    for name, vendor, product, number in (
        ('1-1', '1915', '7777', '4'),
        ('1-2', '1915', '7777', '5'),
        ('1-3', '046d', 'c077', '6'),
    ):
        place = tmp_path / 'usb' / name
        place.mkdir(parents=True)
        told = {'idVendor': vendor, 'idProduct': product, 'busnum': '1', 'devnum': number}
        for key, text in told.items():
            (place / key).write_text(f'{text}\n')
    (tmp_path / 'dev/bus/usb/001').mkdir(parents=True)
    (tmp_path / 'dev/bus/usb/001/004').touch()
    return tmp_path


def test_radios_are_found_with_their_rights(usb):
    first, second = find_devices(usb / 'usb', usb / 'dev')
    assert (first.kind, first.usable) == (RADIO, True)
    assert first.path == usb / 'dev/bus/usb/001/004'
    assert (second.kind, second.usable) == (RADIO, False)


def test_a_machine_without_usb_has_no_devices(tmp_path):
    assert not list(find_devices(tmp_path / 'none', tmp_path))


def test_the_rules_name_every_kind_once():
    lines = [line for line in format_udev_rules().splitlines() if line.startswith('SUBSYSTEMS')]
    assert len(lines) == len(found.DEVICE_KINDS)
    assert all(
        f'"{kind.product}"' in format_udev_rules() and 'uaccess' in format_udev_rules()
        for kind in found.DEVICE_KINDS
    )


def test_nothing_there_is_one_sentence_with_the_remedy():
    with pytest.raises(BadInput, match='plug one in, or give its address'):
        require_hardware([], [], '', '')


def test_a_stream_by_hand_over_the_wrap_of_its_clock():
    """Ten stamps of 100 Hz from 20 ms before the wrap, the fourth lost: 9 of 10 in 90 ms."""
    stamps = [(2**24 - 20 + 10 * k) % 2**24 for k in range(10) if k != 3]
    packets = [
        LogPacket('imu', stamp, {}, 1_000_000 * ((stamp + 1000) % 2**24)) for stamp in stamps
    ]
    figures = compute_stream_statistics(LogBlock('imu', 10, {}), packets)
    assert (figures.requested_rate, figures.packets) == (100.0, 9)
    assert figures.rate == pytest.approx(8 / 0.09)
    assert figures.loss == pytest.approx(0.1)
    assert figures.jitter == pytest.approx(0.0, abs=1e-9)
    assert compute_stream_statistics(LogBlock('imu', 10, {}), []).loss == 1.0


class Talking:
    """A board on a pseudo terminal whose diodes hear a lamp, but for one that is dead."""

    def __init__(self, folder, dialect=1, **more):
        self.path = str(folder / 'ttyACM0')
        self._cable = Cable(folder / 'ttyACM0')
        self._board = EmulatedBoard(time.time_ns(), dialect=dialect, **more)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._talk)
        self.sent = 0

    def _talk(self):
        with suppress(OSError, TypeError, ValueError):  # what a pulled cable raises
            self._say_all()

    def _say_all(self):
        while not self._ended.wait(TALK):
            if answer := self._board.answer_timesync(self._cable.read(), time.time_ns()):
                self._cable.write(answer)
            rows = np.arange(self.sent, self.sent + ROWS)
            wave = 1000 + 500 * (np.sin(2 * np.pi * BEACON * rows / 1e4) > 0)
            light = np.repeat(wave[:, None], 8, axis=1)
            light[:, 6] = 37
            self._cable.write(self._board.encode_light(light.astype(np.uint16)))
            if self.sent % (10 * ROWS) == 0:
                self._cable.write(self._board.encode_status())
            self.sent += ROWS

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._cable.pull()  # nobody reads any more: what is being written would never end
        self._thread.join()


def test_a_drone_and_a_board_are_heard_and_their_figures_told(call, talking):
    with talking() as board, CrazyflieServer(Firmware(BenchBody())) as server:
        words = ('--uri', server.uri, '--port', board.path, '--seconds', '2', '--json')
        status, said = call('hardware', 'check', *words)
        firmware = server.firmware
        assert not firmware.supervisor.armed
        assert firmware.parameters.values['supervisor.landedTimeout'] == 3000  # nothing written
        assert firmware.body.duties == (0.0,) * 4
    told = json.loads(said.out)
    states = {check['name']: check['state'] for check in told['checks']}
    assert status == 1  # for the dead diode
    assert {name for name, state in states.items() if state == 'fail'} == {'diodes'}
    assert states['battery'] == states['supervisor'] == states["board's clock"] == 'ok'
    (duties,) = (check['found'] for check in told['checks'] if check['name'] == 'duties')
    assert duties == (
        'idle thrust 0 of 65535; the firmware does not correct motor duties for the battery '
        'voltage'
    )
    drone = told['drone']
    assert (drone['protocol'], drone['voltage']) == (12, 4.0)
    assert drone['revision'] == '20260800'
    imu = drone['streams'][0]
    # Of 100 Hz: what the emulator cannot send in time on a busy machine is missing.
    assert 0.0 < imu['rate'] < 105.0
    assert drone['latency'] > 0.0
    diodes = told['light_board']['diodes']
    assert diodes[6]['faults'] == ['flat']
    assert (diodes[6]['least'], diodes[6]['largest']) == (37, 37)
    assert diodes[0]['mean'] == pytest.approx(1250.0, abs=20.0)
    assert diodes[0]['snr'] > 100.0
    assert not diodes[0]['spoilt']


def test_a_locked_drone_with_an_empty_cell_and_without_the_app_is_not_in_order(call):
    firmware = Firmware(BenchBody())
    firmware.supervisor.lock()
    firmware.voltage = 3.1
    firmware.parameters.values['lta.app'] = 0
    with CrazyflieServer(firmware) as server:
        status, said = call('hardware', 'check', '--uri', server.uri, '--seconds', '0.5', '--json')
    failed = {
        check['name']: check['found']
        for check in json.loads(said.out)['checks']
        if check['state'] == 'fail'
    }
    assert status == 1
    assert set(failed) == {'battery', 'supervisor', 'lta.app'}
    assert 'locked the motors: switch the Crazyflie off and on' in failed['supervisor']
    assert failed['battery'].startswith('3.10 V')


def test_stock_firmware_under_a_blimp_is_told_what_it_lacks(call):
    with CrazyflieServer(Firmware(BenchBody(), build=ARMING)) as server:
        status, said = call('hardware', 'check', '--uri', server.uri, '--seconds', '0.5', '--json')
    checks = {check['name']: check for check in json.loads(said.out)['checks']}
    assert status == 1
    assert {name for name, check in checks.items() if check['state'] == 'fail'} == {
        'duties',
        'lta.app',
        'lta.compensated',
    }
    assert 'not have the effect battery_compensation' in checks['duties']['found']
    assert checks['duties']['remedy'].startswith('Flash the firmware of firmware/crazyflie, or')
    assert checks['powerDist.idleThrust']['found'].startswith(
        '7000, but must be 0 (otherwise the motors turn'
    )


def test_torn_frames_and_another_dialect_are_told(call, talking):
    with talking(transmit=FrameFaults(corrupt=20), dialect=2) as board:
        status, said = call('hardware', 'check', '--port', board.path, '--seconds', '2', '--json')
    told = json.loads(said.out)
    assert status == 1
    found = {check['name']: check for check in told['checks']}
    assert 'uses version 2 of the messages' in found['light board']['found']
    assert told['light_board']['crc_errors'] > 0
    assert found['light']['state'] == 'warn'


def test_nobody_at_an_address_is_told_with_a_remedy(call):
    server = CrazyflieServer(Firmware(BenchBody()))
    server.close()
    status, said = call('hardware', 'check', '--uri', server.uri, '--seconds', '0.5')
    assert status == 1
    assert 'Switch the Crazyflie on' in said.out


def test_a_missing_port_is_one_sentence(call, tmp_path):
    status, said = call('hardware', 'check', '--port', str(tmp_path / 'none'))
    assert status == 2
    assert said.err.startswith('There is no serial port')
    assert said.err.count('\n') == 1
