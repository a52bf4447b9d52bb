# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hostile logs for `lta import`: each function writes one into a folder and returns its path."""

import bz2
import gzip
import os
import sqlite3
import struct
import zlib

import zstandard

HEADER = b't,x,y,z,qw,qx,qy,qz\n'
ULOG = b'ULog\x01\x12\x35\x01' + bytes(8)
USD = struct.pack('<BHH', 0xBC, 2, 1)


def written(folder, data, name='hostile.csv'):
    path = folder / name
    path.write_bytes(data)
    return path


def gzip_bomb(folder):
    layer = gzip.compress(HEADER, 9)
    member = gzip.compress((1 << 20) * b'1,2,3,4,0,0,0,1\n', 9)
    return written(folder, layer + 12 * member, 'hostile.csv.gz')


def gzip_cut(folder):
    return written(folder, gzip.compress(HEADER + 9999 * b'1,2,3\n')[:60], 'hostile.csv.gz')


def line_without_an_end(folder):
    return written(folder, b't,' + 40_000_000 * b'x')


def columns_without_an_end(folder):
    return written(folder, b't' + 400_000 * b',a' + b'\n1\n')


def quote_without_an_end(folder):
    return written(folder, HEADER + b'"' + 20_000_000 * b'\n1,')


def rows_of_any_length(folder):
    return written(folder, HEADER + b'1,2\n1,2,3,4,5,6,7,8,9\n\n,\n')


def formulas(folder):
    return written(folder, HEADER + b'=cmd|"/c calc"!A0,@SUM(1),+1,-1,0,0,0,0\n')


def numbers_that_are_none(folder):
    return written(folder, HEADER + b'1,nan,inf,1e999,0x10,--1,1_000,\xff\n')


def text_with_nul(folder):
    return written(folder, HEADER + b'1,\0,2\n')


def ulog_cut(folder):
    return written(folder, ULOG[:12], 'hostile.ulg')


def ulog_claims_much(folder):
    return written(folder, ULOG + 2000 * struct.pack('<HB', 0xFFFF, ord('F')), 'hostile.ulg')


def ulog_of(folder, told):
    """Write a log of one message of the type that is told."""
    data = struct.pack('<HB', len(told), ord('F')) + told
    data += struct.pack('<HBBH', 4, ord('A'), 0, 1) + b'a'
    data += struct.pack('<HBH', 20, ord('D'), 1) + bytes(18)
    return written(folder, ULOG + data, 'hostile.ulg')


def ulog_format_in_itself(folder):
    return ulog_of(folder, b'a:uint64_t timestamp;a inner;')


def ulog_array_claims_much(folder):
    return ulog_of(folder, b'a:uint64_t timestamp;float[999999999] x;')


def usd_without_an_end(folder):
    return written(folder, USD + struct.pack('<H', 1) + 100_000 * b'a', 'hostile')


def usd_claims_much(folder):
    head = struct.pack('<BHH', 0xBC, 2, 0xFFFF) + struct.pack('<H', 1) + b'e\0'
    return written(folder, head + struct.pack('<H', 0xFFFF) + b'a.b(f)\0', 'hostile')


def usd_type_that_is_code(folder):
    head = USD + struct.pack('<H', 1) + b'e\0' + struct.pack('<H', 1) + b'a.b(__import__)\0'
    return written(folder, head, 'hostile')


def ros1(folder, *records):
    return written(folder, b'#ROSBAG V2.0\n' + b''.join(records), 'hostile.bag')


def ros1_record(fields, data, length=None):
    head = b''.join(
        struct.pack('<I', len(key) + 1 + len(value)) + key + b'=' + value
        for key, value in fields.items()
    )
    size = len(data) if length is None else length
    return struct.pack('<I', len(head)) + head + struct.pack('<I', size) + data


def ros1_cut(folder):
    return ros1(folder)


def ros1_claims_much(folder):
    return ros1(folder, struct.pack('<I', 0xFFFFFFFF), bytes(100))


def ros1_index_outside(folder):
    fields = {b'op': b'\x03', b'index_pos': struct.pack('<Q', 1 << 62)}
    fields |= {b'conn_count': b'\1\0\0\0', b'chunk_count': b'\1\0\0\0'}
    return ros1(folder, ros1_record(fields, 4027 * b' '))


def ros1_bomb(folder):
    bomb = bz2.compress(bytes(80 << 20))
    fields = {b'op': b'\x05', b'compression': b'bz2', b'size': struct.pack('<I', 0xFFFFFFFF)}
    return ros1(folder, ros1_record(fields, bomb))


METADATA = """rosbag2_bagfile_information:
  version: 5
  storage_identifier: sqlite3
  relative_file_paths: [{file}]
  duration: {{nanoseconds: 1}}
  starting_time: {{nanoseconds_since_epoch: 1}}
  message_count: 1
  topics_with_message_count: [{{topic_metadata: {{name: /a, type: std_msgs/msg/Bool,
    serialization_format: cdr, offered_qos_profiles: {qos}}}, message_count: 1}}]
  compression_format: '{kind}'
  compression_mode: '{mode}'
"""
TOPICS = (
    'CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT, '
    'offered_qos_profiles TEXT)'
)
MESSAGES = 'CREATE TABLE messages(id INTEGER, topic_id INTEGER, timestamp INTEGER, data BLOB)'
ENDLESS = (
    'WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) '
    'SELECT max(x) AS schema_version FROM c'
)


def sqlite(folder, statements, file='x.db3', qos="''", kind='', mode=''):
    inside = folder / 'hostile'
    inside.mkdir()
    with sqlite3.connect(inside / 'x.db3') as base:
        for statement, *values in statements:
            base.execute(statement, values)
    base.close()
    text = METADATA.format(file=file, qos=qos, kind=kind, mode=mode)
    (inside / 'metadata.yaml').write_text(text)
    return inside


def sqlite_view_without_an_end(folder):
    return sqlite(folder, [[TOPICS], [MESSAGES], [f'CREATE VIEW schema AS {ENDLESS}']])


def sqlite_computed_column(folder):
    odd = MESSAGES.replace('data BLOB', 'data BLOB GENERATED ALWAYS AS (zeroblob(900000000))')
    row = 'INSERT INTO messages(id, topic_id, timestamp) VALUES (1, 1, 1)'
    return sqlite(folder, [[TOPICS], [odd], [row]])


def sqlite_message_bomb(folder):
    packed = zstandard.ZstdCompressor(write_content_size=False).compress(bytes(150 << 20))
    rows = [['INSERT INTO messages VALUES (1, 1, 1, ?)', packed]]
    return sqlite(folder, [[TOPICS], [MESSAGES], *rows], kind='zstd', mode='MESSAGE')


def sqlite_file_bomb(folder):
    inside = sqlite(folder, [[TOPICS], [MESSAGES]], 'x.db3.zstd', kind='zstd', mode='FILE')
    packed = zstandard.ZstdCompressor().compress(bytes(150 << 20))
    (inside / 'x.db3.zstd').write_bytes(packed)
    return inside


def sqlite_qos_is_deep(folder):
    return sqlite(folder, [[TOPICS], [MESSAGES]], qos="'" + 100_000 * '[' + "'")


def sqlite_metadata_is_deep(folder):
    inside = sqlite(folder, [[TOPICS], [MESSAGES]])
    (inside / 'metadata.yaml').write_text(200_000 * '[')
    return inside


def sqlite_that_climbs(folder):
    return sqlite(folder, [[TOPICS], [MESSAGES]], '../../../etc/passwd')


def sqlite_that_is_none(folder):
    inside = sqlite(folder, [[TOPICS]])
    (inside / 'x.db3').write_bytes(b'SQLite format 3\0' + bytes(5000))
    return inside


def pipe(folder):
    os.mkfifo(folder / 'hostile.csv')
    return folder / 'hostile.csv'


def device(folder):
    (folder / 'hostile.csv').symlink_to('/dev/zero')
    return folder / 'hostile.csv'


def bytes_of_nothing(folder):
    return written(folder, bytes(range(256)) * 40)


def columns_by_thousands(folder):
    names = b','.join(b'c%d' % k for k in range(100_000))
    rows = 3 * (100_000 * b'1,' + b'\n')
    return written(folder, b't,' + names + b'\n' + rows)


def mat_element(kind, data):
    return struct.pack('<II', kind, len(data)) + data + bytes(-len(data) % 8)


def mat_head(kind, size=True):
    flags = mat_element(6, struct.pack('<II', kind, 0))
    return flags + size * mat_element(5, struct.pack('<2i', 1, 1)) + mat_element(1, b'a')


def mat_of(folder, outer, packed=False, levels=30_000):
    """Write a MATLAB file of a number within as many variables of a kind."""
    data = mat_head(6) + mat_element(9, struct.pack('<d', 1.0))
    parts = [data]
    size = len(data)
    for _ in range(levels):
        parts.append(outer + struct.pack('<II', 14, size))
        size += len(parts[-1])
    data = struct.pack('<II', 14, size) + b''.join(reversed(parts))
    if packed:
        data = zlib.compress(data)
        data = struct.pack('<II', 15, len(data)) + data
    head = b'MATLAB 5.0 MAT-file'.ljust(124) + struct.pack('<H', 0x0100) + b'IM'
    return written(folder, head + data, 'hostile.mat')


def mat_of_cells(folder):
    return mat_of(folder, mat_head(1))


def mat_of_cells_compressed(folder):
    return mat_of(folder, mat_head(1), packed=True)


def mat_of_structs(folder):
    return mat_of(
        folder, mat_head(2) + struct.pack('<HHi', 5, 4, 8) + mat_element(1, b'a' * 7 + b'\0')
    )


def mat_of_functions(folder):
    return mat_of(folder, mat_head(16))


def mat_of_opaque_objects(folder):
    return mat_of(folder, mat_head(17, size=False) + 2 * mat_element(1, b'b'))


def mat_of_cells_within_reach(folder):
    return mat_of(folder, mat_head(1), levels=900)


TEXTS = (
    gzip_bomb, gzip_cut, line_without_an_end, columns_without_an_end, quote_without_an_end,
    rows_of_any_length, formulas, numbers_that_are_none, text_with_nul,
)  # fmt: skip
LOGS = (
    ulog_cut, ulog_claims_much, ulog_format_in_itself, ulog_array_claims_much, usd_without_an_end,
    usd_claims_much, usd_type_that_is_code, ros1_cut, ros1_claims_much, ros1_index_outside,
    ros1_bomb, sqlite_view_without_an_end, sqlite_computed_column, sqlite_message_bomb,
    sqlite_file_bomb, sqlite_qos_is_deep, sqlite_metadata_is_deep, sqlite_that_climbs,
    sqlite_that_is_none, pipe, device, bytes_of_nothing,
)  # fmt: skip
# What a draft reads and refuses
DRAFTED = (
    columns_by_thousands, mat_of_cells, mat_of_cells_compressed, mat_of_structs, mat_of_functions,
    mat_of_opaque_objects, mat_of_cells_within_reach,
)  # fmt: skip
