"""No malformed packet turns a motor: `test/score/crazyflie_noise.py`, and fewer of them."""

from pathlib import Path
from random import Random
import sys

from lta_emulation.crazyflie.firmware_build import APP, ARMING
from lta_emulation.crazyflie.packet import CrtpPacket
import pytest

FOLDER = Path(__file__).resolve().parents[3] / 'score'
COUNT = 10_000  # packets to a drone
NUMBER = b'\x05\0'  # of the override, in these tests


@pytest.fixture(scope='module')
def noise():
    sys.path.insert(0, str(FOLDER))
    try:
        import crazyflie_noise

        yield crazyflie_noise
    finally:
        sys.path.remove(str(FOLDER))


@pytest.mark.parametrize('seed', range(1, 6))
@pytest.mark.parametrize('build', [APP, ARMING], ids=['app', 'arming'])
def test_no_malformed_packet_turns_a_motor(noise, build, seed):
    suffered = noise.to_drone(COUNT, Random(seed), build)
    assert not suffered.turned
    assert suffered.packets > 0.9 * COUNT


@pytest.mark.parametrize(
    ('packet', 'obeyed'),
    [
        (CrtpPacket(9, 1, b'\x01\x01'), True),
        (CrtpPacket(9, 1, b'\x01'), True),  # what follows is left by an earlier packet
        (CrtpPacket(9, 1, b'\x03\x01'), False),
        (CrtpPacket(13, 0, b'\x01\x01\x63'), True),
        (CrtpPacket(2, 2, NUMBER + b'\x01'), True),
        (CrtpPacket(2, 2, NUMBER), True),
        (CrtpPacket(2, 2, NUMBER + b'\x01\x63\x63'), True),  # nothing looks at its length
        (CrtpPacket(2, 2, b'\x06\0\x01'), False),
        (CrtpPacket(2, 1, NUMBER + b'\x01'), False),
        (CrtpPacket(2, 3, b'\0motorPowerSet\0enable\0\x08\x01'), True),
        (CrtpPacket(2, 3, b'\0motorPowerSet\0m1\0\x09\x01\x01'), False),
        (CrtpPacket(7, 0, b'\x0a' + bytes(16)), False),
    ],
)
def test_only_what_the_firmware_obeys_as_a_command_is_no_noise(noise, packet, obeyed):
    assert noise.is_command(packet, packet.data.ljust(30, b'\0'), NUMBER) == obeyed
