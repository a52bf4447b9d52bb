"""Compressed bytes, undone within bounds whatever they claim to hold."""

from lta_config.limits import CHUNK_BYTES
import lz4.frame
import zstandard

MAGICS = {b'\x28\xb5\x2f\xfd': 'zstd', b'\x04\x22\x4d\x18': 'lz4'}
KINDS = ('zstd', 'lz4', '')


class DamagedRecord(Exception):
    """A record does not hold what it should; the text, if any, says why in a half-sentence."""


def detect_compression(name: str, packed: bytes | memoryview) -> str:
    """Return how bytes are packed: as their own first bytes tell, or else by name."""
    return MAGICS.get(bytes(packed[:4]), name) if name != '' else ''


def decompress(kind: str, packed: bytes | memoryview) -> bytes | memoryview:
    """
    Return what was packed; bytes behind a frame's end are ignored.

    Parameters
    ----------
    kind : str
        One of `KINDS`; '' is not packed at all.
    packed : bytes or memoryview
        The packed bytes.

    Raises
    ------
    Damaged
        If the kind is unknown, the bytes are no such frame, or hold more than `CHUNK_BYTES`.

    """
    if kind == '':
        return packed
    try:
        if kind == 'zstd':
            return decompress_zstd(packed)
        if kind == 'lz4':
            return decompress_lz4(packed)
    except (zstandard.ZstdError, RuntimeError, ValueError, EOFError, MemoryError) as error:
        raise DamagedRecord from error
    raise DamagedRecord(f"are compressed as '{kind}', which is unknown here")


def decompress_zstd(packed: bytes | memoryview) -> bytes:
    """Return what a zstd frame holds; see `decompress`."""
    claimed = zstandard.frame_content_size(packed[:18])
    if claimed > CHUNK_BYTES:
        raise DamagedRecord(f'claim to hold {claimed} bytes')
    if claimed >= 0:
        return zstandard.ZstdDecompressor().decompress(packed)
    with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
        data = stream.read(CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'hold more than {CHUNK_BYTES} bytes')
    return data


def decompress_lz4(packed: bytes | memoryview) -> bytes:
    """Return what an lz4 frame holds; see `decompress`."""
    unpacker = lz4.frame.LZ4FrameDecompressor()
    data: bytes = unpacker.decompress(packed, max_length=CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'hold more than {CHUNK_BYTES} bytes')
    if not unpacker.eof:
        raise DamagedRecord
    return data


def frame_length(kind: str, packed: bytes | memoryview) -> int:
    """Return how many of some bytes are the frame that they begin with; it must be whole."""
    if kind == 'zstd':
        stream = zstandard.ZstdDecompressor().decompressobj()
        stream.decompress(packed)
        return len(packed) - len(stream.unused_data)
    if kind == 'lz4':
        unpacker = lz4.frame.LZ4FrameDecompressor()
        unpacker.decompress(packed)
        return len(packed) - len(unpacker.unused_data or b'')
    return len(packed)
