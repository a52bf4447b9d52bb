# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Small recordings, ways to damage them, and an oracle of what must survive."""

from dataclasses import dataclass

from lta_bag import BagWriter
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
import numpy as np

TYPES = {'/lta1/a': 'std_msgs/msg/Bool', '/lta1/b': 'sensor_msgs/msg/Image', '/c': 'x/msg/Odd'}
CHUNKS, PER_CHUNK = 8, 12
DAMAGES = ('flip', 'cut', 'both', 'zeros', 'gone', 'added')


@dataclass(frozen=True)
class Chunk:
    """Where a chunk and its packed records lie [bytes], and the messages in it."""

    start: int
    end: int
    packed: tuple[int, int]
    messages: list


@dataclass(frozen=True)
class Whole:
    """A recording as it should be: its bytes and its chunks."""

    data: bytes
    chunks: list


def payloads(rng):
    """Yield topic, log time and bytes; some compress and some do not."""
    for i in range(CHUNKS * PER_CHUNK):
        topic = list(TYPES)[i % 3]
        noise = rng.bytes(int(rng.integers(1, 90)))
        yield topic, 10**9 + i * 10**7, b'\0\1\0\0' + noise + bytes(int(rng.integers(0, 60)))


def by_us(folder):
    """Return a bag of our own recorder."""
    with BagWriter(folder, {'seed': '8', 'note': 60 * 'long '}) as bag:
        known = {**TYPES, '/c': 'std_msgs/msg/String'}
        for topic, type_name in known.items():
            bag.add_topic(topic, type_name, [])
        for i, (topic, time, data) in enumerate(payloads(np.random.default_rng(8))):
            bag.write(topic, data, time)
            if i % PER_CHUNK == PER_CHUNK - 1:
                bag.flush()
    return examined(folder / 'bag_0.mcap')


def by_mcap(folder, compression):
    """Return a bag of mcap's own writer, which announces topics inside the chunks."""
    folder.mkdir()
    with (folder / 'bag_0.mcap').open('wb') as stream:
        writer = Writer(stream, chunk_size=1200, compression=compression)
        writer.start('ros2')
        channels = {}
        for topic, type_name in TYPES.items():
            schema = writer.register_schema(type_name, 'ros2msg', b'bool data')
            channels[topic] = writer.register_channel(topic, 'cdr', schema)
        for topic, time, data in payloads(np.random.default_rng(9)):
            writer.add_message(channels[topic], time, data, time)
        writer.finish()
    return examined(folder / 'bag_0.mcap')


def examined(file):
    """Return a recording with its chunks, as mcap's own reader finds them."""
    data = file.read_bytes()
    chunks = []
    with file.open('rb') as stream:
        reader = make_reader(stream)
        messages = [(m.log_time, m.data) for _, _, m in reader.iter_messages()]
        for found in reader.get_summary().chunk_indexes:
            start, end = found.chunk_start_offset, found.chunk_start_offset + found.chunk_length
            span = found.message_start_time, found.message_end_time
            inside = [m for m in messages if span[0] <= m[0] <= span[1]]
            chunks.append(Chunk(start, end, (end - found.compressed_size, end), inside))
    assert sum(len(chunk.messages) for chunk in chunks) == CHUNKS * PER_CHUNK
    return Whole(data, chunks)


def recordings(folder):
    """Return one recording of each kind."""
    return {
        'ours': by_us(folder / 'bag'),
        **{kind.name: by_mcap(folder / kind.name, kind) for kind in CompressionType},
    }


def damaged(whole, rng):
    """Return a recording's bytes after a random damage, and the messages that must survive."""
    kind = DAMAGES[rng.integers(len(DAMAGES))]
    data = np.frombuffer(whole.data, np.uint8).copy()
    size, hit = len(data), np.zeros(len(data), np.bool_)
    if kind in ('flip', 'both'):
        places = rng.integers(8, size, int(rng.integers(1, 6)))
        data[places] ^= rng.integers(1, 256, len(places)).astype(np.uint8)
        hit[places] = True
    if kind == 'zeros':
        start, length = int(rng.integers(8, size)), int(rng.integers(1, 700))
        hit[start : start + length] = data[start : start + length] != 0
        data[start : start + length] = 0
    cut = int(rng.integers(8, size)) if kind in ('cut', 'both') else size
    at, length = int(rng.integers(8, size)), int(rng.integers(1, 500))
    if kind == 'gone':
        hit[at : at + length] = True
        broken = data[:at].tobytes() + data[at + length :].tobytes()
    elif kind == 'added':
        broken = data[:at].tobytes() + rng.bytes(length) + data[at:].tobytes()
    else:
        broken = data[:cut].tobytes()
    moved = at if kind == 'added' else None
    return (
        kind,
        broken,
        [
            message
            for chunk in whole.chunks
            if survives(chunk, hit, cut, moved)
            for message in chunk.messages
        ],
    )


def survives(chunk, hit, cut, moved):
    """Tell whether a chunk is whole."""
    if chunk.end > cut or (moved is not None and chunk.start < moved < chunk.end):
        return False
    return not hit[chunk.start : chunk.end].any()
