"""The emulated firmware by itself: what real firmware 2026.08 did, in its own words and bytes."""

import errno
import struct

from lta_bridge.crazyflie import duties_packet
from lta_bridge.crazyflie.emulated.body import Bench
from lta_bridge.crazyflie.emulated.firmware import Firmware
from lta_bridge.crazyflie.emulated.link import Link
from lta_bridge.crazyflie.emulated.packet import Packet, unpacked
from lta_bridge.crazyflie.supervisor import Bit
import pytest

HOVER = Packet(7, 0, b'\x0a' + struct.pack('<ffff', 0.0, 0.0, 0.0, 0.45))
STOP_SETPOINT = Packet(7, 0, b'\0')
NOTIFY = Packet(7, 1, b'\0' + bytes(4))
LAND = Packet(8, 0, b'\x08' + bytes(14))
ARM, DISARM = Packet(9, 1, b'\x01\x01'), Packet(9, 1, b'\x01\x00')
EMERGENCY, WATCHDOG = Packet(9, 1, b'\x03'), Packet(9, 1, b'\x04')
OLD_EMERGENCY = Packet(6, 1, b'\x03')


@pytest.fixture
def drone():
    return Firmware(Bench())


def run(drone, begin, end, packet=None, period=0.02):
    """Let time pass with a packet every period; return the time at which the motors stopped."""
    stopped = None
    for turn in range(round((end - begin) / period)):
        now = begin + turn * period
        if packet is not None:
            drone.receive(packet, now)
        drone.tick(now)
        if stopped is None and not any(drone.body.duties):
            stopped = now
    return stopped


def hovering(drone):
    run(drone, 0.0, 0.1)
    drone.receive(ARM, 0.1)
    run(drone, 0.1, 1.0, HOVER)
    assert drone.body.duties == (0.5,) * 4
    return drone


def word(drone, now):
    (answer,) = drone.receive(Packet(9, 0, b'\x0c'), now)
    assert answer.data[0] == 0x8C
    return int.from_bytes(answer.data[1:], 'little')


def test_silence_in_flight_locks_after_two_seconds(drone):
    hovering(drone)
    assert run(drone, 1.0, 4.0) == pytest.approx(3.0, abs=0.05)
    assert word(drone, 4.0) == Bit.LOCKED
    (answer,) = drone.receive(ARM, 4.0)
    assert answer.data == b'\x81\x00\x00'


@pytest.mark.parametrize('packet', [EMERGENCY, OLD_EMERGENCY])
def test_an_emergency_stop_locks_at_once(drone, packet):
    hovering(drone)
    drone.receive(packet, 1.0)
    assert run(drone, 1.0, 1.1, HOVER) == 1.0
    assert word(drone, 1.1) == Bit.LOCKED


def test_one_word_to_the_watchdog_wants_another_every_second(drone):
    hovering(drone)
    drone.receive(WATCHDOG, 1.0)
    assert run(drone, 1.0, 3.0, HOVER) == pytest.approx(2.0, abs=0.05)
    assert word(drone, 3.0) == Bit.LOCKED


def test_disarming_stops_at_once_and_arming_works_again(drone):
    hovering(drone)
    assert drone.receive(DISARM, 1.0)[0].data == b'\x81\x01\x00'
    assert run(drone, 1.0, 1.1, HOVER) == 1.0
    assert word(drone, 1.1) == Bit.CAN_BE_ARMED
    assert drone.receive(ARM, 1.1)[0].data == b'\x81\x01\x01'


def test_a_stop_setpoint_stops_at_once_and_locks_two_seconds_later(drone):
    hovering(drone)
    drone.receive(STOP_SETPOINT, 1.0)
    assert run(drone, 1.0, 2.9) == 1.0
    assert not word(drone, 2.9) & Bit.LOCKED
    run(drone, 2.9, 3.2)
    assert word(drone, 3.2) & Bit.LOCKED


def test_after_the_hand_over_it_lands_and_disarms_itself_unlocked(drone):
    hovering(drone)
    drone.receive(NOTIFY, 1.0)
    (answer,) = drone.receive(LAND, 1.0)
    assert answer.data == b'\x08\x00\x00\x00'
    run(drone, 1.0, 9.0)
    assert not word(drone, 9.0) & Bit.LOCKED


def test_a_coasting_blimp_counts_as_landed_and_is_disarmed_after_five_seconds(drone):
    hovering(drone)
    idle = Packet(13, 2, duties_packet.packed(1, (0.0,) * 4, 1000))
    run(drone, 1.0, 5.9, idle)
    assert word(drone, 5.9) & Bit.ARMED
    run(drone, 5.9, 6.2, idle)
    assert not word(drone, 6.2) & Bit.ARMED


def test_armed_and_idle_it_disarms_itself_after_the_preflight_time(drone):
    drone.receive(Packet(2, 2, struct.pack('<HH', 1, 4000)), 0.0)
    drone.receive(ARM, 0.0)
    run(drone, 0.0, 3.9)
    assert word(drone, 3.9) & Bit.ARMED
    run(drone, 3.9, 4.2)
    assert not word(drone, 4.2) & Bit.ARMED


def test_unarmed_it_ignores_every_command(drone):
    assert run(drone, 0.0, 1.0, HOVER) == 0.0
    full = Packet(13, 2, duties_packet.packed(1, (1.0,) * 4, 1000))
    assert run(drone, 1.0, 2.0, full) == 1.0
    assert drone.body.duties == (0.0,) * 4


def test_duties_hold_for_their_time_out_and_old_ones_are_not_flown(drone):
    drone.receive(ARM, 0.0)
    drone.receive(Packet(13, 2, duties_packet.packed(5, (0.25, 0.5, 0.0, -1.0), 100)), 0.0)
    drone.tick(0.05)
    assert drone.body.duties == pytest.approx((0.25, 0.5, 0.0, 0.0), abs=1e-4)
    drone.receive(Packet(13, 2, duties_packet.packed(4, (1.0,) * 4, 100)), 0.05)
    drone.tick(0.06)
    assert max(drone.body.duties) == pytest.approx(0.5, abs=1e-4)
    drone.tick(0.11)
    assert drone.body.duties == (0.0,) * 4
    run(drone, 0.11, 4.0)
    assert not word(drone, 4.0) & Bit.LOCKED  # the app has let go


def test_log_blocks_are_refused_by_the_firmwares_own_numbers(drone):
    floats = b''.join(struct.pack('<BH', 0x77, number) for number in range(6))

    def create(number, fields):
        return drone.receive(Packet(5, 1, bytes([6, number]) + fields), 0.0)[0].data

    assert create(1, floats) == bytes([6, 1, 0])
    assert create(1, floats) == bytes([6, 1, errno.EEXIST])
    assert create(2, floats + struct.pack('<BH', 0x77, 6)) == bytes([6, 2, errno.E2BIG])
    assert create(3, struct.pack('<BH', 0x77, 999)) == bytes([6, 3, errno.ENOENT])
    assert create(4, floats[:3] + b'\x77') == bytes([6, 4, 0])  # the dangling byte of cflib
    assert drone.receive(Packet(5, 1, b'\x63\x01'), 0.0)[0].data[2] == errno.ENOEXEC
    for number in range(5, 17):
        assert create(number, b'')[2] == 0
    assert create(20, b'')[2] == errno.ENOMEM


def test_log_stamps_wrap_at_24_bits_and_follow_the_drones_clock():
    drone = Firmware(Bench(), boot_ms=(1 << 24) - 25, drift=100e-6)
    drone.receive(Packet(5, 1, b'\x06\x01' + struct.pack('<BH', 0x77, 2)), 0.0)
    drone.receive(Packet(5, 1, b'\x03\x01\x01'), 0.0)  # every 10 ms
    stamps = []
    for turn in range(1, 8):
        stamps += [int.from_bytes(one.data[1:4], 'little') for one in drone.tick(turn * 0.01)]
    assert stamps[:4] == [(1 << 24) - 15, (1 << 24) - 5, 5, 15]
    assert drone.milliseconds(1000.0) - drone.milliseconds(0.0) == 1_000_100


def test_parameters_are_read_written_and_guarded(drone):
    assert drone.receive(Packet(2, 1, b'\0\0'), 0.0)[0].data == b'\0\0\0' + struct.pack('<H', 3000)
    assert drone.receive(Packet(2, 2, b'\0\0\x10\x27'), 0.0)[0].data == b'\0\0\x10\x27'
    assert drone.receive(Packet(2, 1, b'\0\0'), 0.0)[0].data[3:] == struct.pack('<H', 10000)
    read_only = drone.parameters.values['firmware.revision0']
    number = struct.pack('<H', len(drone.parameters.values) - 1)
    assert drone.receive(Packet(2, 2, number + bytes(4)), 0.0) == []
    assert drone.parameters.values['firmware.revision0'] == read_only
    assert drone.receive(Packet(2, 1, b'\x63\0'), 0.0)[0].data == b'\x63\0\x02'


def test_a_link_loses_doubles_and_swaps():
    link = Link(drop=0.5)
    for _ in range(1000):
        link.put(b'a', 0.0)
    assert 440 < len(link.out(0.0)) < 560
    link = Link(double=1.0, delay=0.1)
    link.put(b'a', 0.0)
    assert link.out(0.09) == []
    assert link.out(0.1) == [b'a', b'a']
    link = Link(jitter=0.1)
    for number in range(100):
        link.put(bytes([number]), 1e-3 * number)
    arrived = link.out(1.0)
    assert sorted(arrived) == [bytes([number]) for number in range(100)] != arrived


def test_a_datagram_is_a_header_and_at_most_30_bytes():
    assert unpacked(b'') is None
    assert unpacked(bytes(32)) is None
    assert unpacked(b'\x5e\x01') == Packet(5, 2, b'\x01')  # the reserved bits say nothing
    assert Packet(5, 2, b'\x01').packed() == b'\x52\x01'
