"""Blocks that are missing, late, doubled, and a time that begins anew."""

from lta_config.errors import BadInput
from lta_vlc.receiver import BeaconPresence, BlockSequence
import pytest

PERIOD = 100_000_000
START = 1_000_000_000


def taken(*blocks: float) -> list[int]:
    """Return how many blocks are missing before each of these, counted in blocks."""
    sequence = BlockSequence(PERIOD)
    return [sequence.count_missing_blocks(START + round(block * PERIOD)) for block in blocks]


def test_blocks_go_on_from_one_another():
    assert taken(0, 1, 2, 3) == [0, 0, 0, 0]


def test_a_clock_that_trembles_loses_nothing():
    assert taken(0, 1.3, 2.2, 2.8, 4.2) == [0, 0, 0, 0, 0]


def test_missing_blocks_are_counted():
    sequence = BlockSequence(PERIOD)
    assert [sequence.count_missing_blocks(START + k * PERIOD) for k in (0, 3, 4, 9)] == [
        0,
        2,
        0,
        4,
    ]
    assert sequence.missing == 6


@pytest.mark.parametrize('late', [1, 0, 1.4, 1.4999, -8.9999])
def test_a_block_out_of_order_is_refused_and_the_newest_kept(late):
    sequence = BlockSequence(PERIOD)
    sequence.count_missing_blocks(START + PERIOD)
    with pytest.raises(BadInput, match=r'follows one with 1.100 s, but each block lasts 0.1 s'):
        sequence.count_missing_blocks(START + round(late * PERIOD))
    assert sequence.count_missing_blocks(START + 2 * PERIOD) == 0


def test_a_recording_may_begin_again():
    assert taken(50, 51, 0, 1) == [0, 0, 0, 0]


def test_presence_takes_blocks_that_are_missing_for_silent():
    assert BeaconPresence(True).update_presence(False, 4) == (True, 4)
    assert BeaconPresence(True).update_presence(False, 5) == (False, 0)
    assert BeaconPresence(True, 4).update_presence(True) == (True, 0)
    assert BeaconPresence().update_presence(True).update_presence(True) == (True, 0)


def test_gaps_between_stamps_are_rounded_to_whole_blocks():
    assert taken(0, 0.5) == [0, 0]
    assert taken(0, 1.49) == [0, 0]
    assert taken(0, 1.5) == [0, 1]
    assert taken(0, 2.49, 3.49) == [0, 1, 0]
    assert taken(10, 0, 1) == [0, 0, 0]  # ten blocks back, a new sequence begins
