"""
The packet that carries our allocation's duties to the app aboard (port 13, channel 2).

`<BB4hH`: 0x4C, sequence, four duties of M1 to M4 in 1/32767, time-out in ms. The app stops the
motors when no newer packet has come within the time-out; `firmware/crazyflie/` reads the same.
"""

from collections.abc import Sequence
import struct
from typing import NamedTuple

MARK = 0x4C
FULL = 32767
FORM = struct.Struct('<BB4hH')


class DutiesPacket(NamedTuple):
    """Sequence 0 to 255, duty -1 to 1 of M1 to M4, and for how long they hold. [ms]"""

    sequence: int
    duties: tuple[float, ...]
    timeout_ms: int


def pack_duties(sequence: int, duties: Sequence[float], timeout_ms: int) -> bytes:
    """
    Return the payload.

    Parameters
    ----------
    sequence : int
        Any count; it is told modulo 256.
    duties : sequence of 4 floats
        Clipped to -1 to 1; what is no number is 0.
    timeout_ms : int
        0 to 65535.

    """
    steps = [round(FULL * max(-1.0, min(1.0, duty))) if duty == duty else 0 for duty in duties]
    return FORM.pack(MARK, sequence & 0xFF, *steps, timeout_ms)


def unpack_duties(data: bytes) -> DutiesPacket | None:
    """Return what a payload says; None where it is none of ours."""
    if len(data) != FORM.size or data[0] != MARK:
        return None
    _, sequence, *steps, timeout_ms = FORM.unpack(data)
    return DutiesPacket(sequence, tuple(step / FULL for step in steps), timeout_ms)


def is_newer(sequence: int, than: int) -> bool:
    """Tell whether a sequence number is ahead of another by less than half of the circle."""
    return 0 < (sequence - than) & 0xFF < 128
