# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The emulated firmware by itself: what real firmware 2026.08 did, in its own words and bytes."""

import errno
import struct

from bench_body import BenchBody
from lta_bridge.crazyflie import duties_packet
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_emulation.crazyflie.firmware import CrtpPacket, Firmware, unpack_datagram
from lta_emulation.crazyflie.parameters import APP, ARMING, AS_SOLD
from lta_emulation.crazyflie.server import LossyLink
from lta_emulation.crazyflie.supervisor import EVALUATION_PERIOD, SupervisorState
import pytest

HOVER = CrtpPacket(7, 0, b'\x0a' + struct.pack('<ffff', 0.0, 0.0, 0.0, 0.45))
NOTIFY = CrtpPacket(7, 1, b'\0' + bytes(4))
LAND = CrtpPacket(8, 0, b'\x08' + bytes(14))
ARM = CrtpPacket(9, 1, b'\x01\x01')


STILL = (0.0,) * 4
AT_ONCE = 2 * EVALUATION_PERIOD  # s: the supervisor looks every 40 ms


@pytest.fixture
def drone():
    """A drone that needs arming and flies setpoints."""
    return Firmware(BenchBody(), build=ARMING._replace(idle_thrust=0))


@pytest.fixture
def app():
    """A drone with the app."""
    return Firmware(BenchBody())


def run(drone, begin, end, packet=None, period=0.02):
    """Let time pass with a packet every period; return the time at which the motors stopped."""
    stopped = None
    for turn in range(round((end - begin) / period)):
        now = begin + turn * period
        if packet is not None:
            drone.receive(packet(turn) if callable(packet) else packet, now)
        drone.tick(now)
        if stopped is None and not any(drone.body.duties):
            stopped = now
    return stopped


def duties(*wanted, timeout_ms=200, sequence=1):
    return CrtpPacket(13, 2, duties_packet.pack_duties(sequence, wanted, timeout_ms))


def number(drone, name):
    """Return a parameter's number, as packets have it."""
    return struct.pack('<H', drone.parameters._contents.numbers[name])


def write(drone, name, layout, value, now=0.0):
    drone.receive(CrtpPacket(2, 2, number(drone, name) + struct.pack(layout, value)), now)


def hovering(drone):
    run(drone, 0.0, 0.1)
    drone.receive(ARM, 0.1)
    run(drone, 0.1, 1.0, HOVER)
    assert drone.body.duties == (0.5,) * 4
    return drone


def word(drone, now):
    (answer,) = drone.receive(CrtpPacket(9, 0, b'\x0c'), now)
    assert answer.data[0] == 0x8C
    return int.from_bytes(answer.data[1:], 'little')


def test_upside_down_in_flight_it_crashes_and_recovers_upright(drone):
    hovering(drone)
    drone.acceleration = (0.0, 0.0, -1.0)
    assert run(drone, 1.0, 1.4, HOVER) == pytest.approx(1.1, abs=AT_ONCE)
    assert word(drone, 1.4) == SupervisorBit.CRASHED | SupervisorBit.TUMBLED
    recover = CrtpPacket(9, 1, b'\x02')
    assert drone.receive(recover, 1.4)[0].data == b'\x82\x00\x00'
    drone.acceleration = None
    run(drone, 1.4, 1.5)
    assert drone.receive(recover, 1.5)[0].data == b'\x82\x01\x01'
    run(drone, 1.5, 1.7)
    assert word(drone, 1.7) == SupervisorBit.CAN_BE_ARMED


@pytest.mark.parametrize(
    ('acceleration', 'turned_over'),
    [((0.0, 0.9, 0.45), True), ((0.0, 0.8, 0.55), False), ((0.05, 0.0, -0.05), False)],
)
def test_tilted_for_a_second_is_tumbled_and_free_fall_is_not(drone, acceleration, turned_over):
    hovering(drone)
    drone.acceleration = acceleration
    run(drone, 1.0, 1.9, HOVER)
    assert drone.supervisor.state is SupervisorState.FLYING
    run(drone, 1.9, 2.3, HOVER)
    assert drone.supervisor.crashed == turned_over


def test_without_its_check_it_minds_no_tumble(drone):
    write(drone, 'supervisor.tmblChckEn', '<B', 0)
    hovering(drone)
    drone.acceleration = (0.0, 0.0, -1.0)
    run(drone, 1.0, 3.0, HOVER)
    assert drone.supervisor.state is SupervisorState.FLYING


# Builds.


def test_while_it_starts_it_hears_nothing_and_turns_nothing():
    drone = Firmware(BenchBody(), build=AS_SOLD, up_at=2.0)
    assert run(drone, 0.0, 1.9, HOVER) == 0.0
    assert drone.receive(CrtpPacket(15, 0, b'a'), 1.9) == []
    assert run(drone, 1.9, 2.0, HOVER) == 1.9
    assert drone.body.duties == STILL
    run(drone, 2.0, 2.2, HOVER)
    assert drone.body.duties == (0.5,) * 4


@pytest.mark.parametrize(
    ('build', 'written', 'read'),
    [(APP, 0, 6), (APP, 1, 1), (APP, 7, 6), (AS_SOLD, 0, 1), (AS_SOLD, 6, 1), (AS_SOLD, 2, 2)],
)
def test_a_controller_that_there_is_not_is_not_taken(build, written, read):
    drone = Firmware(BenchBody(), build=build)
    write(drone, 'stabilizer.controller', '<B', written)
    assert drone.parameters.values['stabilizer.controller'] == read


# The app.


def test_duties_hold_for_their_time_out_and_old_ones_are_not_flown(app):
    app.receive(ARM, 0.0)
    app.receive(duties(0.25, 0.5, 0.0, -1.0, timeout_ms=100, sequence=5), 0.0)
    app.tick(0.05)
    assert app.body.duties == pytest.approx((0.25, 0.5, 0.0, 0.0), abs=1e-4)
    app.receive(duties(1.0, 1.0, 1.0, 1.0, timeout_ms=100, sequence=4), 0.05)
    app.tick(0.06)
    assert max(app.body.duties) == pytest.approx(0.5, abs=1e-4)
    app.tick(0.11)
    assert app.body.duties == STILL
    run(app, 0.11, 6.0)
    assert word(app, 6.0) == SupervisorBit.CAN_BE_ARMED  # not locked: the app has let go


# Packets of a wrong length.


def test_what_is_too_little_is_read_of_an_earlier_packet(app):
    app.receive(CrtpPacket(15, 0, bytes(range(100, 130))), 0.0)
    name = number(app, 'supervisor.landedTimeout')
    assert app.receive(CrtpPacket(2, 2, name + b'\x01'), 0.0)[0].data == name + b'\x01'
    assert app.parameters.values['supervisor.landedTimeout'] == 1 + (103 << 8)
    assert app.receive(CrtpPacket(2, 1, name[:1]), 0.0)[0].data[:3] == name + b'\0'


@pytest.mark.parametrize(
    ('name', 'kind', 'status'),
    [
        (b'supervisor\0landedTimeout', 0x09, 0),
        (b'supervisor\0landedTimeout', 0x19, errno.EINVAL),
        (b'supervisor\0landedTimeou', 0x09, errno.ENOENT),
        (b'firmware\0revision0', 0x0A, errno.EACCES),
    ],
)
def test_a_parameter_is_set_by_its_name_and_type(app, name, kind, status):
    before = app.parameters.values['supervisor.landedTimeout']
    packet = b'\0' + name + b'\0' + bytes([kind]) + b'\x0a\0'
    (answer,) = app.receive(CrtpPacket(2, 3, packet), 0.0)
    assert answer.data == b'\0' + name + b'\0' + bytes([status])
    assert app.parameters.values['supervisor.landedTimeout'] == (before if status else 10)


@pytest.mark.parametrize(
    'packet',
    [
        CrtpPacket(7, 0), CrtpPacket(7, 0, HOVER.data[:-1]), CrtpPacket(7, 0, HOVER.data + b'\0'),
        CrtpPacket(7, 0, b'\x0b' + bytes(14)), CrtpPacket(7, 0, b'\x06' + bytes(27)),
        CrtpPacket(7, 0, b'\x03\x02' + bytes(11)), CrtpPacket(7, 1, NOTIFY.data[:-1]),
    ],
)  # fmt: skip
def test_a_setpoint_of_a_wrong_length_stops_the_motors_and_the_drone(drone, packet):
    """The firmware asserts: it starts anew, and then fails its self-test."""
    hovering(drone)
    drone.receive(packet, 1.0)
    assert drone.halted
    assert run(drone, 1.0, 1.2, HOVER) == 1.0
    assert drone.receive(CrtpPacket(15, 0, b'a'), 1.2) == []


@pytest.mark.parametrize(
    'packet',
    [
        CrtpPacket(7, 0, b'\0\1\2'), CrtpPacket(7, 0, b'\x07'), CrtpPacket(7, 0, b'\x0c'),
        CrtpPacket(7, 1, b'\1'),
        CrtpPacket(7, 0, b'\x0b' + bytes(15)), CrtpPacket(7, 0, b'\x06' + bytes(28)),
        CrtpPacket(7, 0, b'\x03\x02' + bytes(12)), CrtpPacket(7, 2, b'\x0a'), NOTIFY,
    ],
)  # fmt: skip
def test_other_setpoints_are_taken_whatever_their_length(drone, packet):
    hovering(drone)
    drone.receive(packet, 1.0)
    assert not drone.halted


def test_the_supervisor_answers_each_of_its_questions(drone):
    hovering(drone)
    told = [drone.receive(CrtpPacket(9, 0, bytes([which])), 1.0)[0].data for which in range(1, 12)]
    assert told[:8] == [bytes([0x81 + bit, word(drone, 1.0) >> bit & 1]) for bit in range(8)]
    assert drone.receive(CrtpPacket(9, 0), 1.0) == drone.receive(CrtpPacket(9, 1), 1.0) == []


def test_older_questions_are_answered_on_the_port_of_the_platform(drone):
    run(drone, 0.0, 0.1)
    for packet, answer in (
        (b'\x01', b'\x01\x00\x00'),  # too short to arm
        (b'\x01\x01', b'\x01\x01\x01'),
        (b'\x02', b'\x02\x01\x01'),
        (b'\x03\x01', b''),
        (b'\x63\x01', b'\x63\x01'),
    ):
        assert drone.receive(CrtpPacket(13, 0, packet), 0.1)[0].data == answer
    assert drone.receive(CrtpPacket(13, 1, b'\1'), 0.1)[0].data == b'\x012026.08'
    assert drone.receive(CrtpPacket(13, 1, b'\x63'), 0.1) == []


def test_landing_is_refused_while_nothing_may_fly(drone):
    assert drone.receive(LAND, 0.0)[0].data[3] == errno.EBUSY
    assert drone.receive(CrtpPacket(8, 0, b'\x63\0\0'), 0.0)[0].data[3] == errno.ENOEXEC


def test_motor_power_set_has_three_ways_and_no_fourth(app):
    for number_, ratio in enumerate((65535, 0, 13107, 26214), start=1):
        write(app, f'motorPowerSet.m{number_}', '<H', ratio)
    wanted = {0: STILL, 1: (1.0, 0.0, 0.2, 0.4), 2: (1.0,) * 4, 3: (1.0,) * 4, 4: STILL}
    for enable, motors in wanted.items():
        write(app, 'motorPowerSet.enable', '<B', enable)
        app.tick(0.0)
        assert app.body.duties == pytest.approx(motors)


def test_log_blocks_are_refused_by_the_firmwares_own_numbers(drone):
    floats = b''.join(struct.pack('<BH', 0x77, number) for number in range(6))

    def create(number, fields):
        return drone.receive(CrtpPacket(5, 1, bytes([6, number]) + fields), 0.0)[0].data

    assert create(1, floats) == bytes([6, 1, 0])
    assert create(1, floats) == bytes([6, 1, errno.EEXIST])
    assert create(2, floats + struct.pack('<BH', 0x77, 6)) == bytes([6, 2, errno.E2BIG])
    assert create(3, struct.pack('<BH', 0x77, 999)) == bytes([6, 3, errno.ENOENT])
    assert create(4, floats[:3] + b'\x77') == bytes([6, 4, 0])  # the dangling byte of cflib
    assert drone.receive(CrtpPacket(5, 1, b'\x63\x01'), 0.0)[0].data[2] == errno.ENOEXEC
    assert drone.receive(CrtpPacket(5, 1, b'\x04\x63'), 0.0)[0].data[2] == errno.ENOENT
    for number in range(5, 17):
        assert create(number, b'')[2] == 0
    assert create(20, b'')[2] == errno.ENOMEM


def test_log_stamps_wrap_at_24_bits_and_follow_the_drones_clock():
    drone = Firmware(BenchBody(), boot_ms=(1 << 24) - 25, drift=100e-6)
    drone.receive(CrtpPacket(5, 1, b'\x06\x01' + struct.pack('<BH', 0x77, 2)), 0.0)
    drone.receive(CrtpPacket(5, 1, b'\x03\x01\x01'), 0.0)  # every 10 ms
    stamps = []
    for turn in range(1, 8):
        stamps += [int.from_bytes(one.data[1:4], 'little') for one in drone.tick(turn * 0.01)]
    assert stamps[:4] == [(1 << 24) - 15, (1 << 24) - 5, 5, 15]
    assert drone.clock_ms(1000.0) - drone.clock_ms(0.0) == 1_000_100


def test_parameters_are_read_written_and_guarded(drone):
    assert drone.receive(CrtpPacket(2, 1, b'\0\0'), 0.0)[0].data == b'\0\0\0' + struct.pack(
        '<H', 3000
    )
    assert drone.receive(CrtpPacket(2, 2, b'\0\0\x10\x27'), 0.0)[0].data == b'\0\0\x10\x27'
    assert drone.receive(CrtpPacket(2, 1, b'\0\0'), 0.0)[0].data[3:] == struct.pack('<H', 10000)
    read_only = drone.parameters.values['firmware.revision0']
    number = struct.pack('<H', len(drone.parameters.values) - 1)
    assert drone.receive(CrtpPacket(2, 2, number + bytes(4)), 0.0) == []
    assert drone.parameters.values['firmware.revision0'] == read_only
    assert drone.receive(CrtpPacket(2, 1, b'\x63\0'), 0.0)[0].data == b'\x63\0\x02'


def test_a_link_loses_doubles_and_swaps():
    link = LossyLink(drop=0.5)
    for _ in range(1000):
        link.send(b'a', 0.0)
    assert 440 < len(link.receive(0.0)) < 560
    link = LossyLink(double=1.0, delay=0.1)
    link.send(b'a', 0.0)
    assert link.receive(0.09) == []
    assert link.receive(0.1) == [b'a', b'a']
    link = LossyLink(jitter=0.1)
    for number in range(100):
        link.send(bytes([number]), 1e-3 * number)
    arrived = link.receive(1.0)
    assert sorted(arrived) == [bytes([number]) for number in range(100)] != arrived


def test_a_datagram_is_a_header_and_at_most_30_bytes():
    assert unpack_datagram(b'') is None
    assert unpack_datagram(bytes(32)) is None
    assert unpack_datagram(b'\x5e\x01') == CrtpPacket(
        5, 2, b'\x01'
    )  # the reserved bits say nothing
    assert CrtpPacket(5, 2, b'\x01').pack_datagram() == b'\x52\x01'


def test_a_parameter_is_stored_and_cleared_as_in_param_logic(drone):
    """Its state is the default, and the stored value behind it where there is one."""
    which = number(drone, 'ring.effect')

    def ask(request, channel=3, data=b''):
        (answer,) = drone.receive(CrtpPacket(2, channel, request + which + data), 0.0)
        return answer.data[len(request) + 2 :]

    assert ask(b'', 2, b'\x0a') == b'\x0a'  # a write is echoed
    assert ask(b'\x04') == b'\x00\x06'
    assert ask(b'\x05') == bytes([errno.ENOENT])
    assert ask(b'\x03') == b'\x00'
    assert ask(b'\x04') == b'\x01\x06\x0a'
    assert ask(b'\x05') == b'\x00'
    assert ask(b'\x04') == b'\x00\x06'


def test_a_trajectory_is_kept_in_a_memory(drone):
    """As crtp_mem.c answers; nothing is written beyond its 4096 bytes."""

    def ask(channel, data):
        (answer,) = drone.receive(CrtpPacket(4, channel, data), 0.0)
        return answer.data

    assert ask(0, b'\x01') == b'\x01\x01'
    assert ask(0, b'\x02\x00') == b'\x02\x00\x12' + struct.pack('<I', 4096) + bytes(8)
    assert ask(0, b'\x02\x01') == b'\x02\x01'
    at = struct.pack('<BI', 0, 4090)
    assert ask(2, at + b'abcdef') == at + b'\x00'
    assert ask(2, at + b'abcdefg') == at + bytes([errno.EIO])
    assert ask(1, at + b'\x06') == at + b'\x00abcdef'
    assert ask(1, at + b'\x07') == at + bytes([errno.EIO])
    assert ask(1, b'\x01' + at[1:] + b'\x06') == b'\x01' + at[1:] + bytes([errno.EIO])
