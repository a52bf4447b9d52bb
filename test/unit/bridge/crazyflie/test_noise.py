# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
No malformed CRTP packet turns a motor, crashes or hangs a drone.

Three kinds are no malformed packets and are left out, because the firmware obeys them as it
should: a request to arm (port 9, and the older one on port 13), and a write to the parameter
`motorPowerSet.enable`, which turns motors whatever the supervisor says. The firmware looks at the
length of none of them (crtp_supervisor.c, platformservice.c, param_logic.c), so they are left out
at any length. A setpoint of a wrong length makes the firmware assert: motors stop, and it wants to
be switched off and on. Here that is done at once, and counted.
"""

from random import Random
from typing import NamedTuple

from bench_body import BenchBody
from lta_emulation.crazyflie.firmware import CrtpPacket, Firmware, unpack_datagram
from lta_emulation.crazyflie.parameters import APP, ARMING, list_parameters
import pytest

COUNT = 10_000  # packets to a drone
PORTS = (0, 2, 4, 5, 6, 7, 8, 9, 13, 14, 15)
REQUESTS = ((9, 1), (13, 0))  # ports and channels on which 1 asks to arm
WRITE, OTHER = (2, 2), (2, 3)
OVERRIDE = 'motorPowerSet.enable'
STEP = 1e-4  # s between two packets
LOOK = 50  # packets between two looks at the motors


class Suffered(NamedTuple):
    """What became of a drone: whether a motor turned, packets that counted, times it asserted."""

    turned: bool
    packets: int
    asserted: int


def datagram(random):
    """Return one that is anything: any length from none to too long, known ports more often."""
    header = random.choice(PORTS) << 4 | random.randrange(16)
    return bytes([header]) + random.randbytes(random.randrange(34))


def is_command(packet: CrtpPacket, seen: bytes, override: bytes) -> bool:
    """
    Tell whether the firmware obeys a packet by turning motors, or by arming.

    `packet`: as it came. `seen`: what the firmware sees of it: behind a short one, what an earlier
    one left. `override`: number of `motorPowerSet.enable`.
    """
    where = packet[:2]
    if where in REQUESTS:
        return seen[0] == 1
    if where == OTHER:
        return seen[:1] == b'\0' and seen[1:].startswith(OVERRIDE.replace('.', '\0').encode())
    return where == WRITE and seen[:2] == override


def to_drone(count, random, build) -> Suffered:
    """Return what became of an unarmed drone under so many packets."""
    names = [entry.name for entry in list_parameters(build)]
    override = names.index(OVERRIDE).to_bytes(2, 'little')
    drone, begun = Firmware(BenchBody(), build=build), 0.0
    seen, packets, asserted, turned = bytearray(30), 0, 0, False
    for turn in range(count):
        now = STEP * turn - begun
        packet = unpack_datagram(datagram(random))
        if packet is not None and not is_command(packet, _over(packet.data, seen), override):
            seen[: len(packet.data)] = packet.data
            drone.receive(packet, now)
            packets += 1
        if turn % LOOK == 0 or drone.halted:
            drone.tick(now)
            turned |= any(drone.body.duties)
        if drone.halted:
            drone, begun, asserted = Firmware(BenchBody(), build=build), STEP * turn, asserted + 1
            seen = bytearray(30)
    return Suffered(turned, packets, asserted)


def _over(data: bytes, seen: bytes) -> bytes:
    """Return a payload with what lies behind it."""
    return data + bytes(seen[len(data) :])


@pytest.mark.parametrize('seed', range(1, 6))
@pytest.mark.parametrize('build', [APP, ARMING], ids=['app', 'arming'])
def test_no_malformed_packet_turns_a_motor(build, seed):
    suffered = to_drone(COUNT, Random(seed), build)
    assert not suffered.turned
    assert suffered.packets > 0.9 * COUNT
