"""The light board's messages: fresh, and what MAVLink's own generator makes of the same XML."""

from importlib.util import module_from_spec, spec_from_file_location
import io
import os
from pathlib import Path
import sys

from lta_bridge.teensy.dialect import LTA_LIGHT_BLOCK, MESSAGES
from lta_bridge.teensy.frame_parser import FrameParser
from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
XML = ROOT / 'firmware/light_board/mavlink/link.xml'


def loaded(name, path):
    """Return a Python file as a module."""
    spec = spec_from_file_location(name, path)
    module = module_from_spec(spec)
    sys.modules[name] = module  # its dataclasses and pymavlink look themselves up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope='module')
def theirs(tmp_path_factory):
    """Return what pymavlink's generator makes of our XML."""
    from pymavlink.generator import mavgen

    path = tmp_path_factory.mktemp('dialect') / 'theirs.py'
    options = mavgen.Opts(str(path), wire_protocol='2.0', language='Python3', validate=True)
    assert mavgen.mavgen(options, [str(XML)])
    return loaded('theirs', path)


def test_the_python_is_that_of_the_xml():
    tool = loaded('dialect_tool', ROOT / 'tools/dialect.py')
    assert tool.TARGET.read_text() == tool.text()


def test_fields_and_checks_are_those_of_the_generator(theirs):
    assert MESSAGES.keys() == theirs.mavlink_map.keys()
    for number, ours in MESSAGES.items():
        other = theirs.mavlink_map[number]
        assert (ours.name, ours.crc_extra) == (other.msgname, other.crc_extra)
        assert list(ours.layout.names) == other.ordered_fieldnames
        assert ours.layout.itemsize == other.unpacker.size


def test_the_messages_of_common_are_unchanged_and_ours_are_in_nobody_s_way():
    from pymavlink.dialects.v20 import all as everybody
    from pymavlink.dialects.v20 import common

    for number in (0, 111):
        assert MESSAGES[number].crc_extra == common.mavlink_map[number].crc_extra
        assert list(MESSAGES[number].layout.names) == common.mavlink_map[number].ordered_fieldnames
    own = {number for number, message in MESSAGES.items() if message.name.startswith('LTA_')}
    assert len(own) == 3
    assert own.isdisjoint(everybody.mavlink_map)


def test_their_decoder_reads_our_light(theirs):
    light = np.random.default_rng(1).integers(0, 4096, (45, 8)).astype(np.uint16)
    board = EmulatedBoard(0, first=2**32 - 15)
    found = theirs.MAVLink(io.BytesIO()).parse_buffer(
        board.encode_light(light) + board.encode_status()
    )
    names = [message.get_type() for message in found]
    assert names == ['LTA_LIGHT_BLOCK'] * 3 + ['HEARTBEAT', 'LTA_LIGHT_STATUS']
    assert np.concatenate([m.samples for m in found[:3]]).reshape(45, 8).tolist() == light.tolist()
    assert [m.sequence for m in found[:3]] == [2**32 - 15, 0, 15]
    assert [m.time_usec for m in found[:3]] == [0, 1500, 3000]


def test_we_read_their_encoder(theirs):
    out = io.BytesIO()
    other = theirs.MAVLink(out, 1, 191)
    samples = [*range(4000, 4117), 0, 0, 0]
    other.lta_light_block_send(2**40 + 5, 7, 8, 15, samples)
    other.timesync_send(-3, 2**60)
    block, time = FrameParser().parse_frames(out.getvalue())
    assert block.message is LTA_LIGHT_BLOCK
    assert block.record['time_usec'] == 2**40 + 5
    assert block.record['samples'].tolist() == samples
    assert (block.record['sequence'], block.record['diodes'], block.record['rows']) == (7, 8, 15)
    assert (time.record['tc1'], time.record['ts1']) == (-3, 2**60)
    assert (block.system, block.component) == (1, 191)


def test_a_field_that_a_newer_dialect_adds_is_left(theirs):
    """TIMESYNC of today's common.xml has two bytes more; its check does not cover their names."""
    out = io.BytesIO()
    theirs.MAVLink(out, 1, 191).timesync_send(5, 9)
    frame = bytearray(out.getvalue())
    assert frame[1] == 9  # zeros at the end are not sent
    body = frame[:1] + bytes([18]) + frame[2:10] + frame[10:19] + bytes(7) + b'\1\2'
    check = MESSAGES[111].checksum(body).to_bytes(2, 'little')
    (found,) = FrameParser().parse_frames(bytes(body) + check)
    assert (found.record['tc1'], found.record['ts1']) == (5, 9)


def test_no_environment_variable_switches_the_check_off(monkeypatch):
    """The generated reader takes anything where MAV_IGNORE_CRC is set; ours does not."""
    monkeypatch.setitem(os.environ, 'MAV_IGNORE_CRC', '1')
    frame = bytearray(EmulatedBoard(0).encode_light(np.full((15, 8), 9, np.uint16)))
    frame[30] ^= 1
    framing = FrameParser()
    assert list(framing.parse_frames(bytes(frame))) == []
    assert framing.crc_errors == 1
