"""
What a packet of a Crazyflie must look like before anything is believed of it.

cflib reads whatever has the right port: it takes a log packet that is too long for one that fits,
and what is too short ends in an exception that it logs. So each packet is looked at here first.
"""

from collections.abc import Mapping
from typing import Final

from lta_bridge.crazyflie.log_table import LogBlock, SIZES

MOST: Final = 30  # bytes of payload (CRTP)
LOG, DATA = 5, 2  # port and channel of log packets
STAMPED: Final = 4  # bytes before the values of a log packet: block, 24 bits of milliseconds
# Of each port that a drone speaks on: the channels, and the fewest bytes (firmware, crtp.h).
CHANNELS: Final[Mapping[int, Mapping[int, int]]] = {
    0: {0: 0},  # console
    2: {0: 1, 1: 2, 2: 2, 3: 1},  # parameters
    4: {0: 1, 1: 1, 2: 1},  # memory
    LOG: {0: 1, 1: 3, DATA: STAMPED},
    6: {1: 1},  # localization
    8: {0: 1},  # high-level commander
    9: {0: 1, 1: 1},  # supervisor
    13: {0: 1, 1: 1, 2: 0},  # platform, app
    15: {0: 0, 1: 0, 2: 0, 3: 0},  # link: echo, source, sink, null
}


def block_size(block: LogBlock) -> int:
    """Return how many bytes the values of a log block take."""
    return sum(SIZES[kind] for kind in block.variables.values())


def find_packet_fault(port: int, channel: int, data: bytes, sizes: Mapping[int, int]) -> str:
    """
    Return what is wrong with a packet; empty where it can be read.

    Parameters
    ----------
    port, channel : int
        0 to 15, 0 to 3.
    data : bytes
        Payload.
    sizes : mapping of int to int
        Bytes of values by the number of each log block that was asked for; none before the first
        is, when blocks of an earlier connection may still come.

    """
    where, size = f'{port}:{channel}', len(data)
    if size > MOST:
        return f'{size} bytes on {where}, where a packet carries {MOST}'
    fewest = CHANNELS.get(port, {}).get(channel)
    if fewest is None:
        return f'{where} is no port and channel of a Crazyflie'
    if size < fewest:
        return f'{size} bytes on {where}, where there are {fewest} at least'
    if (port, channel) == (LOG, DATA) and sizes:
        wanted = sizes.get(data[0])
        if wanted is None:
            return f'log block {data[0]} was never asked for'
        if size != STAMPED + wanted:
            return f'log block {data[0]} has {size - STAMPED} bytes of values instead of {wanted}'
    return ''
