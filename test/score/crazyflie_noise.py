"""
Malformed CRTP packets, both ways: no crash, no hang, no motor command.

`python test/score/crazyflie_noise.py [COUNT]`: half of them to the emulated drone, unarmed; half
to cflib and the bridge behind it, as log packets, answers and noise from the drone.
"""

from collections import Counter
from random import Random
import sys
import time

from lta_bridge.crazyflie.bridge import Asked, Bridge
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.emulated.body import Bench
from lta_bridge.crazyflie.emulated.firmware import Firmware
from lta_bridge.crazyflie.emulated.packet import unpacked
from lta_bridge.crazyflie.emulated.server import Server
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.crazyflie.safety import Asked as AskedBy
from lta_config.crazyflie_file import load_crazyflie

PORTS = (0, 2, 4, 5, 6, 7, 8, 9, 13, 14, 15)
ARMING = ((9, 1), (13, 0))  # a packet of chance may be a request to arm: not malformed


class Told:
    """A link that counts what a bridge would send."""

    def __init__(self):
        self.sent = Counter()

    def __getattr__(self, name):
        return lambda *_, **__: self.sent.update([name])


def datagram(random):
    """Return one that is anything: any length from none to too long, known ports more often."""
    header = random.choice(PORTS) << 4 | random.randrange(16)
    return bytes([header]) + random.randbytes(random.randrange(34))


def to_drone(count, random):
    """Return whether a motor turned in an unarmed drone."""
    drone = Firmware(Bench())
    turned = False
    for turn in range(count):
        packet = unpacked(datagram(random))
        if packet is not None and packet[:2] not in ARMING:
            drone.receive(packet, 1e-4 * turn)
        if turn % 50 == 0:
            drone.tick(1e-4 * turn)
            turned |= any(drone.body.duties)
    return turned


def to_bridge(count, random, patience=60.0):
    """Return what the bridge sent and heard, whether cflib went deaf, and whether it hears on."""
    told = Told()
    file = load_crazyflie('gtmab')
    bridge = Bridge(told, file, list(file.motors.values()))
    with Server(Firmware(Bench())) as server:
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
            bridge.heard(event)
    now = time.time_ns()
    bridge.commanded(Asked(now, duties=(1.0,) * 4))
    bridge.tick(1e-9 * now, now, linked=True, active=True, asked=AskedBy())


def main(count):
    random, begun = Random(1), time.monotonic()
    turned = to_drone(count // 2, random)
    sent, heard, deaf, well = to_bridge(count // 2, random, patience=600.0)
    print(  # noqa: T201
        f'{count} packets in {time.monotonic() - begun:.0f} s; to the drone: motors turned '
        f'{turned}; to the bridge: sent {dict(sent)}, {heard} log packets heard, '
        f'connected anew {deaf}, hears on {well}'
    )
    return turned or sent['duties'] or sent['hover'] or not well


if __name__ == '__main__':
    sys.exit(bool(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)))
