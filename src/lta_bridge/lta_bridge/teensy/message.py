"""Encode and decode the MAVLink 2 messages of the light board."""

from dataclasses import dataclass
from typing import Any, final

from fastcrc.crc16 import mcrf4xx
import numpy as np

MARKER = 0xFD  # first byte of a MAVLink 2 frame
HEADER = 10  # bytes before the payload
CHECKSUM = 2  # bytes after it
SIGNATURE = 13  # bytes after that in a signed frame
SIGNED = 0x01  # the only incompatibility flag of MAVLink 2


@final
@dataclass(frozen=True, slots=True)
class MavlinkMessage:
    """One message of the dialect."""

    number: int  # message id
    name: str  # name in the XML
    crc_extra: int  # checksum seed that ensures that both ends use the same fields
    layout: 'np.dtype[np.void]'  # fields in the order of the wire, little endian and packed

    def parse_payload(self, payload: bytes | bytearray) -> np.void:
        """Return the fields of a payload; trailing zeros are not sent, unknown fields are cut."""
        size = self.layout.itemsize
        return np.frombuffer(bytes(payload[:size]).ljust(size, b'\0'), self.layout)[0]  # type: ignore[no-any-return]

    def build_frame(self, turn: int, system: int, component: int, **values: Any) -> bytes:  # noqa: ANN401
        """
        Return the bytes of a frame.

        Parameters
        ----------
        turn : int
            Number of frames sent before; sent modulo 256.
        system, component : int
            MAVLink ids of the sender.
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
