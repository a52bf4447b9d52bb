"""Decompress data with bounds on the size, whatever the headers declare."""

from lta_config.limits import CHUNK_BYTES
import lz4.frame
import zstandard

MAGICS = {b'\x28\xb5\x2f\xfd': 'zstd', b'\x04\x22\x4d\x18': 'lz4'}
KINDS = ('zstd', 'lz4', '')


class DamagedRecord(Exception):
    """A damaged record; the text, if any, is the reason as a clause."""


def detect_compression(name: str, packed: bytes | memoryview) -> str:
    """Return the compression of bytes by their magic number, otherwise by name."""
    return MAGICS.get(bytes(packed[:4]), name) if name != '' else ''


def decompress(kind: str, packed: bytes | memoryview) -> bytes | memoryview:
    """
    Return the uncompressed data; bytes behind the end of a frame are ignored.

    `kind` is one of `KINDS`; '' means uncompressed.

    Raises
    ------
    DamagedRecord
        If the kind is unknown, the frame is invalid, or it exceeds `CHUNK_BYTES`.

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
    raise DamagedRecord(
        f"are compressed with '{kind}', which is not supported (only zstd and lz4 are)"
    )


def decompress_zstd(packed: bytes | memoryview) -> bytes:
    """Decompress a zstd frame; see `decompress`."""
    # A zstd frame header has at most 18 bytes.
    claimed = zstandard.frame_content_size(packed[:18])
    if claimed > CHUNK_BYTES:
        raise DamagedRecord(
            f'decompress to {claimed} bytes; the limit for a chunk is {CHUNK_BYTES} bytes'
        )
    if claimed >= 0:
        return zstandard.ZstdDecompressor().decompress(packed)
    with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
        data = stream.read(CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'decompress to more than the limit of {CHUNK_BYTES} bytes')
    return data


def decompress_lz4(packed: bytes | memoryview) -> bytes:
    """Decompress an lz4 frame; see `decompress`."""
    unpacker = lz4.frame.LZ4FrameDecompressor()
    data: bytes = unpacker.decompress(packed, max_length=CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'decompress to more than the limit of {CHUNK_BYTES} bytes')
    if not unpacker.eof:
        raise DamagedRecord
    return data


def frame_length(kind: str, packed: bytes | memoryview) -> int:
    """Return the length of the complete frame at the start of some bytes."""
    if kind == 'zstd':
        stream = zstandard.ZstdDecompressor().decompressobj()
        stream.decompress(packed)
        return len(packed) - len(stream.unused_data)
    if kind == 'lz4':
        unpacker = lz4.frame.LZ4FrameDecompressor()
        unpacker.decompress(packed)
        return len(packed) - len(unpacker.unused_data or b'')
    return len(packed)
