"""Blocks that are missing, late, doubled, and a time that begins anew."""

from lta_config.errors import BadInput
from lta_vlc.presence import Presence
from lta_vlc.sequence import Sequence
import pytest

PERIOD = 100_000_000
START = 1_000_000_000


def taken(*blocks: float) -> list[int]:
    """Return how many blocks are missing before each of these, counted in blocks."""
    sequence = Sequence(PERIOD)
    return [sequence.take(START + round(block * PERIOD)) for block in blocks]


def test_blocks_go_on_from_one_another():
    assert taken(0, 1, 2, 3) == [0, 0, 0, 0]


def test_a_clock_that_trembles_loses_nothing():
    assert taken(0, 1.3, 2.2, 2.8, 4.2) == [0, 0, 0, 0, 0]


def test_missing_blocks_are_counted():
    sequence = Sequence(PERIOD)
    assert [sequence.take(START + k * PERIOD) for k in (0, 3, 4, 9)] == [0, 2, 0, 4]
    assert sequence.missing == 6


@pytest.mark.parametrize('late', [1, 0, 1.4, 1.4999, -8.9999])
def test_a_block_out_of_order_is_refused_and_the_newest_kept(late):
    sequence = Sequence(PERIOD)
    sequence.take(START + PERIOD)
    with pytest.raises(BadInput, match=r'comes after that of 1.100 s, though a block lasts 0.1 s'):
        sequence.take(START + round(late * PERIOD))
    assert sequence.take(START + 2 * PERIOD) == 0


def test_a_recording_may_begin_again():
    assert taken(50, 51, 0, 1) == [0, 0, 0, 0]


def test_presence_takes_blocks_that_are_missing_for_silent():
    assert Presence(True).after(False, 4) == (True, 4)
    assert Presence(True).after(False, 5) == (False, 0)
    assert Presence(True, 4).after(True) == (True, 0)
    assert Presence().after(True).after(True) == (True, 0)


def test_gaps_between_stamps_are_rounded_to_whole_blocks():
    assert taken(0, 0.5) == [0, 0]
    assert taken(0, 1.49) == [0, 0]
    assert taken(0, 1.5) == [0, 1]
    assert taken(0, 2.49, 3.49) == [0, 1, 0]
    assert taken(10, 0, 1) == [0, 0, 0]  # ten blocks back, a new sequence begins
