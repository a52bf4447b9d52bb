# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light board's messages, as pymavlink's generator writes them from our XML."""

import os
import subprocess
import sys

from light_frames import KINDS
from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np


def test_the_messages_of_common_are_unchanged_and_ours_are_in_nobody_s_way():
    from pymavlink.dialects.v20 import all as everybody
    from pymavlink.dialects.v20 import common

    for name in ('HEARTBEAT', 'TIMESYNC'):
        kind = KINDS[name]
        assert kind.crc_extra == common.mavlink_map[kind.id].crc_extra
        assert kind.ordered_fieldnames == common.mavlink_map[kind.id].ordered_fieldnames
    own = {kind.id for name, kind in KINDS.items() if name.startswith('LTA_')}
    assert len(own) == 3
    assert own.isdisjoint(everybody.mavlink_map)


def test_the_samples_of_the_board_are_on_the_wire_as_the_xml_says():
    """Wide fields come first: time, number of the row, samples, diodes, rows."""
    light = np.random.default_rng(1).integers(1, 4096, (45, 8)).astype(np.uint16)
    frame = np.dtype(
        [
            ('head', 'u1', 10), ('time_usec', '<u8'), ('sequence', '<u4'),
            ('samples', '<u2', (15, 8)), ('diodes', 'u1'), ('rows', 'u1'), ('checksum', '<u2'),
        ]
    )  # fmt: skip
    found = np.frombuffer(EmulatedBoard(0, first=2**32 - 15).encode_light(light), frame)
    assert found['samples'].reshape(45, 8).tolist() == light.tolist()
    assert found['sequence'].tolist() == [2**32 - 15, 0, 15]
    assert found['time_usec'].tolist() == [0, 1500, 3000]
    assert (set(found['diodes']), set(found['rows'])) == ({8}, {15})


def test_no_environment_variable_switches_the_check_off():
    """pymavlink's decoder takes anything where MAV_IGNORE_CRC is set; ours does not."""
    frame = bytearray(EmulatedBoard(0).encode_light(np.full((15, 8), 9, np.uint16)))
    frame[30] ^= 1
    script = f"""
from lta_bridge.teensy.block_assembler import FrameParser
parser = FrameParser()
print(len(list(parser.parse_frames({bytes(frame)!r}))), parser.crc_errors)
"""
    environment = {**os.environ, 'MAV_IGNORE_CRC': '1'}
    words = [sys.executable, '-P', '-c', script]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == '0 1\n'
