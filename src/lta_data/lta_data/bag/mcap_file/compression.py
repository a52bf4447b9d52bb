"""Decompress data with bounds on the size, whatever the headers declare."""

from lta_config.limits import CHUNK_BYTES
import lz4.frame
import zstandard


class DamagedRecord(Exception):
    """A damaged record; the text, if any, is the reason as a clause."""


def decompress(kind: str, packed: bytes | memoryview) -> bytes | memoryview:
    """
    Return the uncompressed data; bytes behind the end of a frame are ignored.

    `kind` is 'zstd', 'lz4' or '', which means uncompressed.

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
        f'are compressed with {kind!r}, which is not supported (only zstd and lz4 are)'
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
