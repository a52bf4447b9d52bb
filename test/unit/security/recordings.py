# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hostile recordings in MCAP: each function writes one into a folder and returns its path."""

import os
import struct
import zlib

import lz4.frame
from mcap.writer import CompressionType, Writer
import zstandard

MAGIC = b'\x89MCAP0\r\n'
PART = 80 * '=' + '\n'
BOOL = b'\0\1\0\0\1'
LONG = (1 << 63) - 1


def text(value):
    data = value.encode() if isinstance(value, str) else value
    return struct.pack('<I', len(data)) + data


def record(opcode, body, length=None):
    return struct.pack('<BQ', opcode, len(body) if length is None else length) + body


def channel(topic='/a', number=1, schema=1, notes=b''):
    return record(4, struct.pack('<HH', number, schema) + text(topic) + text('cdr') + text(notes))


def schema(name='std_msgs/msg/Bool', told='bool data', number=1):
    return record(3, struct.pack('<H', number) + text(name) + text('ros2msg') + text(told))


def message(data=BOOL, number=1, at=1):
    return record(5, struct.pack('<HIQQ', number, 0, at, at) + data)


def chunk(packed, size, kind, crc=0):
    return record(
        6,
        struct.pack('<QQQI', 1, 1, size, crc)
        + text(kind)
        + struct.pack('<Q', len(packed))
        + packed,
    )


def raw(folder, *pieces, name='hostile.mcap'):
    """Write records behind a header, without a summary."""
    path = folder / name
    path.write_bytes(MAGIC + record(1, text('ros2') + text('')) + b''.join(pieces))
    return path


def bag(
    folder,
    name='a/msg/B',
    told='uint8 x\n',
    data=BOOL,
    topics=('/lta1/a',),
    encoding='ros2msg',
    notes=None,
    times=(10**9, 2 * 10**9),
):
    """Write a finished recording of one type."""
    path = folder / 'hostile.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream, compression=CompressionType.NONE)
        writer.start('ros2')
        kind = writer.register_schema(name, encoding, told.encode())
        for topic in topics:
            number = writer.register_channel(topic, 'cdr', kind, notes or {})
            for time in times:
                writer.add_message(number, time, data, time)
        writer.finish()
    return path


def rosbag(folder, metadata):
    """Write a recording's folder with a metadata.yaml of its own."""
    inside = folder / 'hostile'
    inside.mkdir()
    bag(inside)
    (inside / 'metadata.yaml').write_text(metadata)
    return inside


def zstd_bomb(folder):
    packed = zstandard.ZstdCompressor(write_content_size=False).compress(bytes(200 << 20))
    return raw(folder, schema(), channel(), chunk(packed, 200 << 20, 'zstd'))


def lz4_bomb(folder):
    packed = lz4.frame.compress(bytes(200 << 20), store_size=False)
    return raw(folder, schema(), channel(), chunk(packed, 200 << 20, 'lz4'))


def zstd_claims_much(folder):
    head = b'\x28\xb5\x2f\xfd\xe0' + struct.pack('<Q', LONG)
    return raw(folder, schema(), channel(), chunk(head + bytes(50), LONG, 'zstd'))


def zstd_wide_window(folder):
    head = b'\x28\xb5\x2f\xfd\x00\xf8'
    return raw(folder, schema(), channel(), chunk(head + b'\x01\0\0', 0, 'zstd'))


def unknown_compression(folder):
    return raw(folder, schema(), channel(), chunk(BOOL, 5, '../../zip'))


def chunk_claims_much(folder):
    return raw(folder, schema(), channel(), record(6, bytes(60), LONG))


def record_claims_much(folder):
    return raw(folder, schema(), channel(), record(5, bytes(22), LONG))


def text_claims_much(folder):
    return raw(folder, record(3, struct.pack('<HI', 1, 0xFFFFFFFF) + b'x'))


def map_claims_much(folder):
    body = struct.pack('<HH', 1, 1) + text('/a') + text('cdr') + struct.pack('<I', 0xFFFFFFFF)
    return raw(folder, schema(), record(4, body))


def summary_points_outside(folder):
    footer = record(2, struct.pack('<QQI', LONG, LONG, 0))
    return raw(folder, schema(), channel(), message(), footer + MAGIC)


def summary_in_itself(folder):
    start = len(MAGIC) + len(record(1, text('ros2') + text('')))
    index = struct.pack('<QQQQI', 0, 9, start, 20, 0) + struct.pack('<Q', 0) + text('') + bytes(16)
    return raw(folder, record(8, index), record(2, struct.pack('<QQI', start, 0, 0)) + MAGIC)


def chunk_in_a_chunk(folder):
    inner = b''.join([schema(), channel(), message()])
    for _ in range(40):
        inner = chunk(inner, len(inner), '', zlib.crc32(inner))
    return raw(folder, inner)


def many_empty_records(folder):
    return raw(folder, 60_000 * record(0x90, b''))


def channels_by_thousands(folder):
    return raw(folder, schema(), *(channel(f'/a{k}', k) for k in range(1, 5000)), message())


def schemas_by_thousands(folder):
    return raw(
        folder, *(schema(f'a/msg/B{k}', number=k) for k in range(1, 5000)), channel(), message()
    )


def attachment_outside(folder):
    body = (
        struct.pack('<QQ', 1, 1)
        + text('../../../../pwned')
        + text('x')
        + struct.pack('<Q', 2)
        + b'hi'
    )
    body += struct.pack('<I', zlib.crc32(body))
    return raw(folder, schema(), record(9, body), channel(), message())


def times_beyond_the_end(folder):
    return bag(folder, 'std_msgs/msg/Bool', 'bool data\n', times=(0, (1 << 64) - 1))


def type_that_is_code(folder):
    return bag(folder, 'a/msg/B(__import__("os").system("touch pwned") and object or object)')


def type_with_lines(folder):
    return bag(folder, 'a/msg/B:\n    import os; os.system("touch pwned")\nclass C')


def idl_that_is_code(folder):
    code = '"\\"); import os; os.system(\'touch pwned\')"'
    told = f'module a {{ module msg {{ const string x = {code};\nstruct B {{ uint8 x; }}; }}; }};'
    return bag(folder, told=told, encoding='ros2idl')


def constant_that_is_code(folder):
    return bag(folder, told='string X="""\'); __import__("os").system("touch pwned")\nuint8 x\n')


def type_in_itself(folder):
    return bag(folder, 'a/msg/A', f'a/A x\nuint8 y\n{PART}MSG: a/A\na/A x\nuint8 y\n')


def types_in_a_circle(folder):
    return bag(folder, 'a/msg/A', f'a/B[] x\n{PART}MSG: a/B\na/A[] x\n')


def type_without_a_part(folder):
    return bag(folder, told='b/Missing x\nuint8 y\n')


def array_of_millions(folder):
    return bag(folder, 'a/msg/A', f'a/B[300000000] x\n{PART}MSG: a/B\nuint8 y\n')


def array_of_texts(folder):
    return bag(folder, told='string[99999999] x\n')


def arrays_in_arrays(folder):
    kinds = [f'MSG: a/A{k}\na/A{k + 1}[4000] x\n' for k in range(1, 9)]
    return bag(folder, 'a/msg/A0', PART.join(['a/A1[4000] x\n', *kinds, 'MSG: a/A9\nuint8 x\n']))


def definition_that_is_deep(folder):
    kinds = [f'MSG: a/A{k}\na/A{k + 1} x\n' for k in range(1, 1500)]
    return bag(folder, 'a/msg/A0', PART.join(['a/A1 x\n', *kinds, 'MSG: a/A1500\nuint8 x\n']))


def definition_that_is_long(folder):
    return bag(folder, told=''.join(f'uint8 x{k}\n' for k in range(200_000)))


def sequence_claims_much(folder):
    data = b'\0\1\0\0' + struct.pack('<I', 0xFFFFFFFF) + bytes(20)
    return bag(folder, told='float64[] x\n', data=data)


def sequence_of_messages_claims_much(folder):
    data = b'\0\1\0\0' + struct.pack('<I', 0xFFFFFFFF) + bytes(20)
    return bag(folder, 'a/msg/A', f'a/B[] x\n{PART}MSG: a/B\n\n', data=data)


def string_claims_much(folder):
    return bag(
        folder, told='string x\n', data=b'\0\1\0\0' + struct.pack('<I', 0xFFFFFFF0) + b'hi\0'
    )


def message_of_nothing(folder):
    return bag(folder, told='string x\n', data=b'')


def qos_is_a_bomb(folder):
    layers = [f'a{k}: &a{k} [{", ".join(10 * [f"*a{k - 1}"])}]' for k in range(1, 12)]
    return bag(folder, notes={'offered_qos_profiles': '\n'.join(['a0: &a0 [x]', *layers])})


def qos_is_deep(folder):
    return bag(folder, notes={'offered_qos_profiles': 200_000 * '['})


def names_with_markup(folder):
    return bag(folder, topics=('/[/red]x', '/[bold]', '/a:smile:'))


def names_with_escapes(folder):
    return bag(folder, topics=('/\x1b]0;owned\x07', '/\x1b[2J', '/\r/b', '/\u202egnp'))


def names_that_climb(folder):
    return bag(folder, topics=('/../../../pwned', '/..', '//', '', '/a/../../b', '/' + 300 * 'x'))


def names_in_html(folder):
    return bag(folder, topics=('/lta1/<script>alert(1)</script>', '/lta1/"onload="x'))


def metadata_that_climbs(folder):
    (folder / 'outside.mcap').write_bytes(b'secret')
    told = (
        "{rosbag2_bagfile_information: {relative_file_paths: ['../outside.mcap', '/etc/passwd']}}"
    )
    return rosbag(folder, told)


def metadata_that_is_a_pipe(folder):
    inside = rosbag(folder, '')
    (inside / 'metadata.yaml').unlink()
    os.mkfifo(inside / 'metadata.yaml')
    return inside


def recording_that_is_a_pipe(folder):
    inside = folder / 'hostile'
    inside.mkdir()
    os.mkfifo(inside / 'bag_0.mcap')
    return inside


def recording_that_is_a_device(folder):
    inside = folder / 'hostile'
    inside.mkdir()
    (inside / 'bag_0.mcap').symlink_to('/dev/zero')
    return inside


def folder_with_a_circle(folder):
    inside = rosbag(folder, '')
    (inside / 'bag').symlink_to(inside)
    return inside


def only_the_magic(folder):
    path = folder / 'hostile.mcap'
    path.write_bytes(MAGIC)
    return path


def cut_anywhere(folder):
    path = bag(folder)
    path.write_bytes(path.read_bytes()[:-100])
    return path


# What is refused with one sentence, whoever reads it.
REFUSED = (recording_that_is_a_pipe, recording_that_is_a_device)
# What is read as far as it goes, and whose faults are told.
READ = (
    zstd_bomb, lz4_bomb, zstd_claims_much, zstd_wide_window, unknown_compression,
    chunk_claims_much, record_claims_much, text_claims_much, map_claims_much,
    summary_points_outside,
    summary_in_itself, chunk_in_a_chunk, many_empty_records, channels_by_thousands,
    schemas_by_thousands, attachment_outside, times_beyond_the_end, type_that_is_code,
    type_with_lines, idl_that_is_code, constant_that_is_code, type_in_itself, types_in_a_circle,
    type_without_a_part, array_of_millions, array_of_texts, arrays_in_arrays,
    definition_that_is_deep, definition_that_is_long, sequence_claims_much,
    sequence_of_messages_claims_much, string_claims_much, message_of_nothing, qos_is_a_bomb,
    qos_is_deep, names_with_markup, names_with_escapes, names_that_climb, names_in_html,
    metadata_that_climbs, metadata_that_is_a_pipe, folder_with_a_circle, only_the_magic,
    cut_anywhere,
)  # fmt: skip
