"""CRTP packets: a header of port and channel, and up to 30 bytes."""

from typing import final, NamedTuple

LARGEST_PAYLOAD = 30  # bytes of payload


class CrtpPacket(NamedTuple):
    """A CRTP packet."""

    # 0 to 15, 0 to 3
    port: int
    channel: int
    data: bytes = b''  # payload, at most 30 bytes

    def pack_datagram(self) -> bytes:
        """Return the datagram; bits 2 and 3 of the header are zero, as the firmware sends them."""
        return bytes([self.port << 4 | self.channel]) + self.data[:LARGEST_PAYLOAD]

    def build_reply(self, data: bytes) -> 'CrtpPacket':
        """Return a reply on the same port and channel."""
        return CrtpPacket(self.port, self.channel, data)


def unpack_datagram(datagram: bytes) -> CrtpPacket | None:
    """Return the packet in a datagram; None if it is empty or too long."""
    if not 1 <= len(datagram) <= 1 + LARGEST_PAYLOAD:
        return None
    header = datagram[0]
    # Header: port in bits 4 to 7, channel in bits 0 and 1
    return CrtpPacket(header >> 4, header & 3, datagram[1:])


@final
class ReceiveBuffer:
    """
    The firmware's receive buffer.

    Most services do not check the length: after a short packet they read bytes of an earlier one,
    and they ignore surplus bytes.
    """

    def __init__(self) -> None:
        self._bytes = bytearray(LARGEST_PAYLOAD)

    def receive(self, data: bytes) -> bytes:
        """Receive a payload; return all that its service sees."""
        # Bytes behind a short payload stay from earlier packets, as in the firmware
        self._bytes[: len(data)] = data
        return bytes(self._bytes)
