"""
Malformed CRTP packets, both ways: no crash, no hang, no motor command.

`python test/score/crazyflie_noise.py [COUNT] [--seeds N]`: for each of N seeds COUNT packets, a
quarter each to an emulated drone with the app and to one without it, both unarmed; half to cflib
and the bridge behind it, as log packets, answers and noise from the drone.

Of what goes to a drone, three kinds are no malformed packets and are left out, because the
firmware obeys them as it should: a request to arm (port 9, and the older one on port 13), and a
write to the parameter `motorPowerSet.enable`, which turns motors whatever the supervisor says. The
firmware looks at the length of none of them (crtp_supervisor.c, platformservice.c, param_logic.c),
so they are left out at any length. A build that arms itself flies every setpoint, and is no case.

A setpoint of a wrong length makes the firmware assert: motors stop, and it wants to be switched
off and on. Here that is done at once, and counted.
"""

import argparse
from collections import Counter
from random import Random
import sys
import time
from typing import NamedTuple

from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.crazyflie.safety import SafetyRequest
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.firmware_build import APP, ARMING, FirmwareBuild
from lta_emulation.crazyflie.packet import CrtpPacket, unpack_datagram
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.crazyflie.variables import list_parameters
from lta_model.vehicle import load_vehicle

PORTS = (0, 2, 4, 5, 6, 7, 8, 9, 13, 14, 15)
REQUESTS = ((9, 1), (13, 0))  # ports and channels on which 1 asks to arm
WRITE, OTHER = (2, 2), (2, 3)
OVERRIDE = 'motorPowerSet.enable'
STEP = 1e-4  # s between two packets
LOOK = 50  # packets between two looks at the motors


class Told:
    """A link that counts what a bridge would send."""

    def __init__(self):
        self.sent = Counter()

    def __getattr__(self, name):
        return lambda *_, **__: self.sent.update([name])


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


def to_drone(count, random, build: FirmwareBuild = APP) -> Suffered:
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


def to_bridge(count, random, patience=60.0):
    """Return what the bridge sent and heard, whether cflib went deaf, and whether it hears on."""
    told = Told()
    bridge = BridgeCore(told, load_crazyflie('gtmab'), load_vehicle('gtmab'), blind=True)
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = CflibLink(server.uri, BLOCKS, time.time_ns)
        link.open(10.0)
        driver = link._drone.link
        for _ in range(count):
            data = datagram(random)
            if data:
                driver.in_queue.put(packet_of(data))
            if driver.in_queue.qsize() > 1000:
                heed(link, bridge)
        deadline = time.monotonic() + patience
        while driver.in_queue.qsize() and time.monotonic() < deadline:
            heed(link, bridge)
            time.sleep(0.01)
        # A forged "all blocks forgotten" makes cflib deaf; the bridge then connects anew.
        deaf = not hears(link, bridge)
        if deaf:
            link.close()
            link.open(10.0)
        well = hears(link, bridge)
        link.close()
    return told.sent, bridge.packets, deaf, well


def hears(link, bridge, patience=3.0):
    """Return whether a hundred log packets come within some seconds."""
    before, deadline = bridge.packets, time.monotonic() + patience
    while bridge.packets < before + 100 and time.monotonic() < deadline:
        heed(link, bridge)
        time.sleep(0.01)
    return bridge.packets >= before + 100


def packet_of(data):
    """Return a datagram as cflib's receiver makes it."""
    from cflib.crtp.crtpstack import CRTPPacket

    return CRTPPacket(header=data[0], data=data[1:])


def heed(link, bridge):
    """Let the bridge take what has come, and tick with fresh commands, never asked to arm."""
    while not link.events.empty():
        event = link.events.get()
        if isinstance(event, LogPacket):
            bridge.receive_packet(event)
    now = time.time_ns()
    bridge.accept_command(CrazyflieCommand(now, duties=(1.0,) * 4))
    bridge.tick(1e-9 * now, now, linked=True, active=True, request=SafetyRequest())


def wrong(count, seed):
    """Send so many packets of a seed, say what came of it, and return whether that is wrong."""
    random, begun = Random(seed), time.monotonic()
    drones = [to_drone(count // 4, random, build) for build in (APP, ARMING)]
    turned = any(drone.turned for drone in drones)
    sent, heard, deaf, well = to_bridge(count - count // 2, random, patience=600.0)
    print(  # noqa: T201
        f'seed {seed}: {count} packets in {time.monotonic() - begun:.0f} s; to the drone: '
        f'{sum(drone.packets for drone in drones)}, it asserted '
        f'{sum(drone.asserted for drone in drones)} times, motors turned {turned}; to the bridge: '
        f'sent {dict(sent)}, {heard} log packets heard, connected anew {deaf}, '
        f'hears on {well}',
        flush=True,
    )
    return turned or sent['send_duties'] or sent['send_hover_setpoint'] or not well


def main():
    """Return how many seeds went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('count', nargs='?', type=int, default=1_000_000)
    parser.add_argument('--seeds', type=int, default=10)
    told = parser.parse_args()
    return sum(bool(wrong(told.count, seed)) for seed in range(1, told.seeds + 1))


if __name__ == '__main__':
    sys.exit(main())
