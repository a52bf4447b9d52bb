# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A measured recording by others, whole and cut short.

An outdoor flight of a blimp in MCAP; looked for in `../shared/data/outdoor_mcap` beside the
project.
"""

from pathlib import Path

from lta_bag.reader import read_bag
from mcap.reader import make_reader
import pytest

DATA = Path(__file__).resolve().parents[4] / 'shared' / 'data' / 'outdoor_mcap'


@pytest.fixture
def measured():
    """Return the recording's file."""
    found = sorted(DATA.glob('*.mcap'))
    if not found:
        pytest.skip(f'no recording in {DATA}')
    return found[0]


def test_whole_and_cut(tmp_path, measured):
    with measured.open('rb') as stream:
        reader = make_reader(stream)
        chunks = reader.get_summary().chunk_indexes
        theirs = [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in reader.iter_messages(log_time_order=False)
        ]
    bag = read_bag(measured)
    assert list(bag.iterate_messages()) == theirs
    assert bag.is_complete
    middle = chunks[len(chunks) // 2]
    (tmp_path / 'cut.mcap').write_bytes(
        measured.read_bytes()[: middle.chunk_start_offset + middle.chunk_length - 1]
    )
    kept = list(read_bag(tmp_path / 'cut.mcap').iterate_messages())
    assert kept == theirs[: len(kept)]
    # What is before the cut in its chunk, too
    assert kept[-1][1] >= middle.message_start_time
