"""A MAVLink 2 message of the light board's link, and its bytes on the wire."""

from dataclasses import dataclass
from typing import Any, final

from fastcrc.crc16 import mcrf4xx
import numpy as np

MARKER = 0xFD  # begins a MAVLink 2 frame
HEADER = 10  # bytes before the payload
CHECKSUM = 2  # bytes after it
SIGNATURE = 13  # bytes after that in a signed frame
SIGNED = 0x01  # the one incompatibility flag that there is


@final
@dataclass(frozen=True, slots=True)
class MavlinkMessage:
    """
    One message of the dialect.

    Parameters
    ----------
    number : int
        Message id.
    name : str
        Name in the XML.
    crc_extra : int
        Byte by which both ends know that they mean the same fields.
    layout : numpy.dtype
        Fields in the order of the wire, little endian and packed.

    """

    number: int
    name: str
    crc_extra: int
    layout: 'np.dtype[np.void]'

    def parse_payload(self, payload: bytes | bytearray) -> np.void:
        """Return the fields of a payload; zeros at its end are not sent, newer fields are cut."""
        size = self.layout.itemsize
        return np.frombuffer(bytes(payload[:size]).ljust(size, b'\0'), self.layout)[0]  # type: ignore[no-any-return]

    def build_frame(self, turn: int, system: int, component: int, **values: Any) -> bytes:  # noqa: ANN401
        """
        Return a message as it goes on the wire.

        Parameters
        ----------
        turn : int
            Frames sent before, counted by the receiver modulo 256.
        system, component : int
            Who sends.
        **values
            The fields; those left out are zero.

        """
        record = np.zeros(1, self.layout)
        for name, value in values.items():
            record[name][0] = value
        payload = record.tobytes().rstrip(b'\0') or b'\0'
        head = bytes((MARKER, len(payload), 0, 0, turn % 256, system, component))
        body = head + self.number.to_bytes(3, 'little') + payload
        return body + self.checksum(body).to_bytes(CHECKSUM, 'little')

    def checksum(self, body: bytes | bytearray) -> int:
        """Return the checksum of a frame's header and payload (CRC-16/MCRF4XX)."""
        return int(mcrf4xx(bytes(body[1:]) + bytes((self.crc_extra,))))
