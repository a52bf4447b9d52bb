# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Table of the log blocks that the bridge reads from a Crazyflie, and the check of its packets.

Names, types and units are the firmware's. Limits (firmware, log.c): 26 bytes of values per block,
periods of 10 to 2540 ms in steps of 10, 16 blocks and 128 variables in total. cflib does not check
sizes: it accepts log packets that are too long, and raises and logs an exception for packets that
are too short.
"""

from collections.abc import Mapping
from typing import Final, NamedTuple

TYPE_BYTES: Final = {'float': 4, 'uint8_t': 1, 'uint16_t': 2, 'int8_t': 1, 'uint32_t': 4}


class LogBlock(NamedTuple):
    """A log block, sent as one packet per period; `variables` maps `group.name` to its type."""

    name: str
    period_ms: int
    variables: dict[str, str]


def _map_to_type(kind: str, *names: str) -> dict[str, str]:
    return dict.fromkeys(names, kind)


LOG_BLOCKS: Final = (
    LogBlock(
        'imu', 10, _map_to_type('float', *(f'{s}.{a}' for s in ('acc', 'gyro') for a in 'xyz'))
    ),
    LogBlock(
        'air',
        20,
        _map_to_type('float', 'baro.pressure') | _map_to_type('uint16_t', 'range.zrange'),
    ),
    LogBlock(
        'attitude',
        20,
        _map_to_type('float', *(f'stateEstimate.{a}' for a in ('roll', 'pitch', 'yaw'))),
    ),
    LogBlock(
        'motors',
        50,
        _map_to_type(
            'uint16_t', *(f'motor.m{number}' for number in range(1, 5)), 'supervisor.info'
        ),
    ),
    LogBlock('power', 100, _map_to_type('float', 'pm.vbat') | _map_to_type('int8_t', 'pm.state')),
)


LARGEST_PAYLOAD: Final = 30  # bytes, largest payload of CRTP
LOG, DATA = 5, 2  # port and channel of log packets
STAMPED: Final = 4  # bytes before the values of a log packet: block, 24 bits of milliseconds
# Ports that a drone sends on: smallest payload in bytes by channel (firmware, crtp.h).
CRTP_CHANNELS: Final[Mapping[int, Mapping[int, int]]] = {
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
    """Return the size of the values of a log block [bytes]."""
    return sum(TYPE_BYTES[kind] for kind in block.variables.values())


def find_packet_fault(port: int, channel: int, data: bytes, sizes: Mapping[int, int]) -> str:
    """
    Return what is wrong with a packet; empty if it can be read.

    `sizes` holds the bytes of values by number of each requested log block. If it is empty, log
    packets are not checked: those of an earlier connection may still arrive.
    """
    where, size = f'{port}, channel {channel}', len(data)
    if size > LARGEST_PAYLOAD:
        return f'packet of {size} bytes on CRTP port {where}, above the limit of {LARGEST_PAYLOAD}'
    fewest = CRTP_CHANNELS.get(port, {}).get(channel)
    if fewest is None:
        return f'packet on CRTP port {where}, which a Crazyflie does not use'
    if size < fewest:
        return f'packet of {size} bytes on CRTP port {where}, below the minimum of {fewest}'
    if (port, channel) == (LOG, DATA) and sizes:
        expected = sizes.get(data[0])
        if expected is None:
            return f'packet of log block {data[0]}, which was not requested'
        if size != STAMPED + expected:
            return (
                f'log block {data[0]} has {size - STAMPED} bytes of values instead of {expected}'
            )
    return ''
