# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Encode and decode the packet with motor duties for the app on the drone (port 13, channel 2).

`<BB4hH`: 0x4C, sequence, four duties of M1 to M4 in 1/32767, time-out in ms. The app stops the
motors if no newer packet arrives within the time-out. `firmware/crazyflie/` parses it.
"""

from collections.abc import Mapping, Sequence
import struct
from typing import NamedTuple

from lta_config.errors import BadInput

PACKET_MARK = 0x4C  # first byte of every packet
FULL_DUTY = 32767  # integer of full duty
FORM = struct.Struct('<BB4hH')


class DutiesPacket(NamedTuple):
    """Sequence number 0 to 255, duties -1 to 1 of M1 to M4, and their time-out [ms]."""

    sequence: int
    duties: tuple[float, ...]
    timeout_ms: int


def pack_duties(sequence: int, duties: Sequence[float], timeout_ms: int) -> bytes:
    """
    Return the payload of a packet.

    Parameters
    ----------
    sequence : int
        Any count; sent modulo 256.
    duties : sequence of 4 floats
        Clipped to -1 to 1; NaN is sent as 0.
    timeout_ms : int
        0 to 65535.

    """
    # duty == duty is false for NaN only.
    steps = [
        round(FULL_DUTY * max(-1.0, min(1.0, duty))) if duty == duty else 0 for duty in duties
    ]
    return FORM.pack(PACKET_MARK, sequence & 0xFF, *steps, timeout_ms)


def unpack_duties(data: bytes) -> DutiesPacket | None:
    """Return the decoded payload; None if it is not a duties packet."""
    if len(data) != FORM.size or data[0] != PACKET_MARK:
        return None
    _, sequence, *steps, timeout_ms = FORM.unpack(data)
    return DutiesPacket(sequence, tuple(step / FULL_DUTY for step in steps), timeout_ms)


def is_newer(sequence: int, than: int) -> bool:
    """Return whether a sequence number follows another, modulo 256."""
    return 0 < (sequence - than) & 0xFF < 128


def find_rotor_indices(motors: Mapping[str, str], names: Sequence[str]) -> tuple[int, ...]:
    """
    Return the index of the rotor of each motor, M1 to M4.

    Raises
    ------
    BadInput
        If a motor is wired to a rotor that the vehicle does not have.

    """
    for motor, rotor in motors.items():
        if rotor not in names:
            raise BadInput(
                f'The Crazyflie file assigns motor {motor} to the rotor {rotor}, which the '
                f'vehicle does not have; choose one of {", ".join(names)}.'
            )
    return tuple(names.index(rotor) for rotor in motors.values())
