"""Check whether bytes have the shape of an MCAP record."""

import struct
from typing import Final

from lta_data.bag.mcap_file.compression import DamagedRecord
from mcap.opcode import Opcode

COUNT = struct.Struct('<I')
ENTRY = 16  # bytes of an entry in a message index: log time, offset

# The parts of each record. A number is a fixed size in bytes; all others follow their 4-byte
# length: 's' a text, 'b' bytes, 'm' a map of texts, 'e' the entries of a message index, 'h' those
# of a map from channel to number.
SHAPES: Final[dict[int, tuple[int | str, ...]]] = {
    Opcode.HEADER: ('s', 's'),
    Opcode.FOOTER: (20,),
    Opcode.SCHEMA: (2, 's', 's', 'b'),
    Opcode.CHANNEL: (4, 's', 's', 'm'),
    Opcode.MESSAGE_INDEX: (2, 'e'),
    Opcode.CHUNK_INDEX: (32, 'h', 8, 's', 16),
    Opcode.ATTACHMENT_INDEX: (40, 's', 's'),
    Opcode.STATISTICS: (42, 'h'),
    Opcode.METADATA: ('s', 'm'),
    Opcode.METADATA_INDEX: (16, 's'),
    Opcode.SUMMARY_OFFSET: (17,),
    Opcode.DATA_END: (4,),
}
WIDTHS: Final = {'e': ENTRY, 'h': 10}
# Shortest body of each opcode from 0 to 15; NEVER for undefined opcodes.
NEVER = 1 << 62
LEAST: Final = (NEVER, 8, 20, 14, 16, 22, 40, 6, 64, 36, 48, 46, 8, 20, 17, 4)


def is_well_formed(opcode: int, body: bytes) -> bool:
    """Return whether the parts of a record fill its body exactly."""
    try:
        at = 0
        for part in SHAPES[opcode]:
            at = find_part_end(part, body, at)
    except (DamagedRecord, struct.error, UnicodeDecodeError):
        return False
    return at == len(body)


def find_part_end(part: int | str, body: bytes, at: int) -> int:
    """Return the end of a part that starts at `at`."""
    if isinstance(part, int):
        end = at + part
    else:
        start = at + COUNT.size
        length = COUNT.unpack_from(body, at)[0]
        end = start + length
        if end > len(body) or length % WIDTHS.get(part, 1):
            raise DamagedRecord
        if part == 's':
            body[start:end].decode()
        while part == 'm' and start < end:
            start = find_part_end('s', body, find_part_end('s', body, start))
        if part == 'm' and start != end:
            raise DamagedRecord
    if end > len(body):
        raise DamagedRecord
    return end


def is_plausible_head(opcode: int, length: int) -> bool:
    """Return whether opcode and length can start a record; its end may be cut off."""
    return 0 < opcode < len(LEAST) and LEAST[opcode] <= length < 1 << 32
