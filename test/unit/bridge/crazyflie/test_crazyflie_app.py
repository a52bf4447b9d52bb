# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The app of firmware/crazyflie, compiled by the host's compiler and driven by a clock of ours."""

import ctypes
from pathlib import Path
import shutil
import struct
import subprocess

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.crazyflie import duties_packet
import pytest

FOLDER = Path(__file__).resolve().parents[4] / 'firmware/crazyflie'
COMPILER = shutil.which('cc') or shutil.which('gcc')
STRICT = ('-std=c11', '-Wall', '-Wextra', '-Werror', '-Wconversion', '-O1')

pytestmark = pytest.mark.skipif(COMPILER is None, reason='needs a C compiler')


class Control(ctypes.Structure):
    """As in stubs/firmware.h."""

    _fields_ = (('forces', ctypes.c_float * 4), ('mode', ctypes.c_int))


class App:
    """The app in its stubs."""

    def __init__(self, library):
        self.library = library
        self._now = ctypes.c_uint32.in_dll(library, 'host_now_ms')
        self._size = ctypes.c_size_t.in_dll(library, 'host_size')
        self._packet = (ctypes.c_uint8 * 31).in_dll(library, 'host_packet')

    def count(self, name):
        return ctypes.c_int.in_dll(self.library, f'host_{name}').value

    def at(self, now_ms, packet=b''):
        """Let the app look once, at a time; return the forces that it then asks for."""
        self._now.value = now_ms & 0xFFFFFFFF
        self._packet[: len(packet)] = packet
        self._size.value = len(packet)
        self.library.ltaAppStep()
        self._now.value = now_ms & 0xFFFFFFFF
        control = Control()
        self.library.controllerOutOfTree(ctypes.byref(control), None, None, None, 0)
        assert control.mode == 2  # controlModeForce: four forces, one a motor
        return pytest.approx(tuple(control.forces), abs=1e-4)

    def ratios(self, now_ms):
        """Return the steps of 65535 that the firmware makes of the forces at a time."""
        self._now.value = now_ms
        control = Control()
        self.library.controllerOutOfTree(ctypes.byref(control), None, None, None, 0)
        return tuple(int(force * 65535) for force in control.forces)


@pytest.fixture(scope='module')
def library(tmp_path_factory):
    target = tmp_path_factory.mktemp('app') / 'app.so'
    sources = [*FOLDER.glob('src/*.c'), FOLDER / 'stubs/host.c']
    command = [
        COMPILER,
        *STRICT,
        '-shared',
        '-fPIC',
        f'-I{FOLDER / "stubs"}',
        f'-I{FOLDER / "src"}',
        f'-I{FOLDER.parent / "identity"}',
        '-DLTA_COMMIT=0x12345678u',
        '-DLTA_VEHICLE=0x9abcdef0u',
    ]
    subprocess.run([*command, *map(str, sources), '-o', str(target)], check=True)
    return target


@pytest.fixture
def app(library, tmp_path):
    copy = shutil.copy(library, tmp_path / 'own.so')  # a library of its own has its own memory
    return App(ctypes.CDLL(copy))


OFF = (0.0, 0.0, 0.0, 0.0)
SOME = (0.25, 0.5, 0.75, 1.0)


def test_commit_and_vehicle_lie_in_the_image_and_in_parameters(library, app):
    assert b'LTAi' + struct.pack('<II', 0x12345678, 0x9ABCDEF0) in Path(library).read_bytes()
    for name, value in (('commit', 0x12345678), ('vehicle', 0x9ABCDEF0)):
        address = ctypes.c_void_p.in_dll(app.library, f'lta_param_{name}').value
        assert ctypes.c_uint32.from_address(address).value == value


def test_duties_hold_for_their_time_out_and_then_the_motors_stop(app):
    assert app.at(1000) == OFF
    assert app.at(1000, duties_packet.pack_duties(1, SOME, 200)) == SOME
    assert app.at(1199) == SOME
    assert app.at(1200) == OFF


def test_when_packets_end_it_disarms_after_a_second_and_lets_go_of_the_commander(app):
    app.at(900)
    assert app.count('setpoints') == 0
    app.at(1000, duties_packet.pack_duties(1, SOME, 200))
    for now in range(1020, 2180, 20):  # 0.2 s of duties, and a second; a look takes 20 ms
        app.at(now)
    assert app.count('disarmed') == 0
    app.at(2180)
    assert (app.count('disarmed'), app.count('relaxed')) == (1, 0)
    for now in range(2200, 2680, 20):
        app.at(now)
    renewed = app.count('setpoints')
    app.at(2680)
    app.at(9000)
    assert (app.count('setpoints'), app.count('relaxed')) == (renewed, 1)


def test_a_link_that_is_back_within_a_second_flies_on(app):
    app.at(1000, duties_packet.pack_duties(1, SOME, 200))
    for now in range(1020, 2160, 20):
        assert app.at(now) == (SOME if now < 1200 else OFF)
    assert app.at(2160, duties_packet.pack_duties(2, SOME, 200)) == SOME
    assert app.count('disarmed') == 0


def test_a_coasting_drone_counts_as_flying_and_its_pins_stay_low(app):
    """The supervisor disarms what stands for 5 s; one step of 65535 is below the PWM's 8 bits."""
    app.at(1000, duties_packet.pack_duties(1, OFF, 200))
    assert app.ratios(1010) == (0, 0, 0, 0)  # it has not flown yet
    app.at(1020, duties_packet.pack_duties(2, SOME, 200))
    app.at(1040, duties_packet.pack_duties(3, OFF, 200))
    assert app.ratios(1050) == (1, 0, 0, 0)
    assert 1 >> 8 == 0
    assert app.ratios(1240) == (0, 0, 0, 0)  # no packet holds any more
    for now in range(1260, 2900, 20):  # it disarms meanwhile
        app.at(now)
    ctypes.c_int.in_dll(app.library, 'host_armed').value = 1
    app.at(3000, duties_packet.pack_duties(4, OFF, 200))
    assert app.ratios(3010) == (0, 0, 0, 0)  # another flight


def test_what_came_before_arming_keeps_nothing_flying(app):
    armed = ctypes.c_int.in_dll(app.library, 'host_armed')
    armed.value = 0
    app.at(1000, duties_packet.pack_duties(1, SOME, 200))
    armed.value = 1
    app.at(1020, duties_packet.pack_duties(2, OFF, 200))
    assert app.ratios(1030) == (0, 0, 0, 0)


def test_the_clock_may_wrap_and_a_first_packet_may_have_any_number(app):
    begun = 2**32 - 100
    assert app.at(begun, duties_packet.pack_duties(200, SOME, 150)) == SOME
    assert app.at(begun + 149) == SOME
    assert app.at(begun + 150) == OFF


def test_doubled_and_overtaken_packets_do_not_count(app):
    app.at(0, duties_packet.pack_duties(255, SOME, 200))
    assert app.at(10, duties_packet.pack_duties(254, OFF, 200)) == SOME
    assert app.at(20, duties_packet.pack_duties(255, OFF, 200)) == SOME
    assert app.at(30, duties_packet.pack_duties(256, (0.1,) * 4, 200)) == (0.1,) * 4
    assert app.at(500, duties_packet.pack_duties(3, SOME, 200)) == SOME  # nothing held any more
    assert app.at(1000, duties_packet.pack_duties(2, OFF, 200)) == OFF


def test_no_time_at_all_hands_over_at_once_and_no_overtaken_packet_takes_it_back(app):
    app.at(0, duties_packet.pack_duties(1, SOME, 200))
    assert app.at(10, duties_packet.pack_duties(3, SOME, 0)) == OFF
    assert app.at(20, duties_packet.pack_duties(2, SOME, 200)) == OFF
    assert app.at(30, duties_packet.pack_duties(3, SOME, 200)) == OFF
    assert app.at(1100, duties_packet.pack_duties(2, SOME, 200)) == SOME  # of another flight


def test_no_packet_holds_for_longer_than_half_a_second(app):
    app.at(0, duties_packet.pack_duties(1, SOME, 65535))
    assert app.at(499) == SOME
    assert app.at(500) == OFF


def test_rotors_that_do_not_reverse_stand_still_instead(app):
    assert app.at(0, duties_packet.pack_duties(1, (-1.0, -0.5, 0.5, 2.0), 200)) == (0, 0, 0.5, 1)


@given(data=st.binary(max_size=31))
def test_whatever_else_comes_turns_nothing(library, data):
    app = App(ctypes.CDLL(str(library)))
    told = duties_packet.unpack_duties(data)
    forces = app.at(100_000, data)
    assert told is not None or forces == OFF
