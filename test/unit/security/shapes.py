# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hostile shapes for the wind tunnel: each function writes a tunnel file and returns its path."""

import os
import struct

HEAD = 80 * b' '
TUNNEL = """schema: 1
name: hostile
about: A body of somebody else's.
vehicle: gtmab
bodies:
  body:
    stl: {stl}
    unit: m
"""


def tunnel(folder, data=None, stl='hostile.stl'):
    if data is not None:
        (folder / stl).write_bytes(data)
    path = folder / 'hostile.yaml'
    path.write_text(TUNNEL.format(stl=stl))
    return path


def triangle(*corners):
    return struct.pack('<12fH', 0, 0, 1, *corners, 0)


def count_claims_much(folder):
    return tunnel(folder, HEAD + struct.pack('<I', 0xFFFFFFFF) + triangle(*range(9)))


def count_claims_little(folder):
    return tunnel(folder, HEAD + struct.pack('<I', 1) + 9 * triangle(*range(9)))


def corners_that_are_no_numbers(folder):
    return tunnel(folder, HEAD + struct.pack('<I', 4) + 4 * triangle(*9 * [float('nan')]))


def corners_beyond_the_world(folder):
    return tunnel(folder, HEAD + struct.pack('<I', 4) + 4 * triangle(*9 * [3e38]))


def open_surface(folder):
    return tunnel(folder, HEAD + struct.pack('<I', 4) + 4 * triangle(0, 0, 0, 1, 0, 0, 0, 1, 0))


def text_without_an_end(folder):
    return tunnel(folder, b'solid x\n' + 30_000 * b'facet normal 0 0 1\nouter loop\n')


def obj_with_a_library(folder):
    return tunnel(folder, b'mtllib ../../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n')


def gltf_with_a_link(folder):
    return tunnel(folder, b'{"asset": {"version": "2.0"}, "buffers": [{"uri": "/etc/passwd"}]}')


def xml_bomb(folder):
    layers = ''.join(f'<!ENTITY a{k} "{10 * f"&a{k - 1};"}">' for k in range(1, 12))
    text = f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a0 "x">{layers}]><x>&a11;</x>'
    return tunnel(folder, text.encode())


def nothing(folder):
    return tunnel(folder, b'')


def sparse_giant(folder):
    path = tunnel(folder, b'')
    os.truncate(folder / 'hostile.stl', 40 << 30)
    return path


def pipe(folder):
    os.mkfifo(folder / 'hostile.stl')
    return tunnel(folder)


def device(folder):
    (folder / 'hostile.stl').symlink_to('/dev/zero')
    return tunnel(folder)


def file_elsewhere(folder):
    return tunnel(folder, stl='../../../../../../etc/passwd')


def name_with_nul(folder):
    return tunnel(folder, stl='"a\\0b.stl"')


SHAPES = (
    count_claims_much, count_claims_little, corners_that_are_no_numbers, corners_beyond_the_world,
    open_surface, text_without_an_end, obj_with_a_library, gltf_with_a_link, xml_bomb, nothing,
    sparse_giant, pipe, device, file_elsewhere, name_with_nul,
)  # fmt: skip
